#include "kernels/scans/fit_camera.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kFittedPoints = 20000;  // points of a fit with six unknowns or more
constexpr double kFewestPixels = 100;         // points of a fit
constexpr double kWithin = 0.5;               // largest distance of a point from its pixel
constexpr double kShareWithin = 0.95;
constexpr int kFitSteps = 8;
// Coordinates are floats, so that points lie about this far from their pixels at least.
constexpr double kRounding = 0.02;
constexpr double kLargestPlaceError = 0.01;  // of the distance to the points

bool is_focal_length(double f) { return f > 0 && f <= kLargestFocalLength; }

/// Column and row of a pixel.
Vector2d position_of(std::size_t pixel, const PixelGrid& grid) {
  const std::size_t column = pixel % grid.width, row = pixel / grid.width;
  return {static_cast<double>(column), static_cast<double>(row)};
}

}  // namespace

std::optional<Camera> fit_camera(const PixelGrid& grid, PointsView points) {
  // Two separate line fits: u against x/z, v against y/z.
  double n = 0, sx = 0, sxx = 0, su = 0, sxu = 0, sy = 0, syy = 0, sv = 0, syv = 0;
  const auto each = [&](auto&& body) {
    StopCheck check_stop(StopCheck::kPoints);
    for (std::size_t pixel = 0; pixel < grid.point_index.size(); ++pixel) {
      check_stop();
      const std::int32_t i = grid.point_index[pixel];
      if (i == PixelGrid::kNone) continue;
      const Eigen::Vector3f p = points[static_cast<std::size_t>(i)];
      if (!(p.z() > 0)) continue;
      const Vector2d at = position_of(pixel, grid);
      body(at.x(), at.y(), static_cast<double>(p.x()) / p.z(), static_cast<double>(p.y()) / p.z());
    }
  };
  each([&](double u, double v, double x, double y) {
    n += 1, sx += x, sxx += x * x, su += u, sxu += x * u, sy += y, syy += y * y, sv += v,
        syv += y * v;
  });
  const double det_x = n * sxx - sx * sx, det_y = n * syy - sy * sy;
  if (n < kFewestPixels || !(det_x > 0) || !(det_y > 0)) return std::nullopt;
  Camera camera;
  camera.fx = (n * sxu - sx * su) / det_x;
  camera.cx = (su - camera.fx * sx) / n;
  camera.fy = (n * syv - sy * sv) / det_y;
  camera.cy = (sv - camera.fy * sy) / n;
  if (!is_focal_length(camera.fx) || !is_focal_length(camera.fy)) return std::nullopt;

  double within = 0;
  each([&](double u, double v, double x, double y) {
    within += std::abs(camera.fx * x + camera.cx - u) < kWithin &&
              std::abs(camera.fy * y + camera.cy - v) < kWithin;
  });
  if (within < kShareWithin * n) return std::nullopt;
  return camera;
}

namespace {

/// A point and its pixel.
struct PixelPoint {
  Vector3d point;
  Vector2d pixel;
};

/// A pinhole without skew. The columns of the Jacobian are fx, fy, cx, cy, a rotation and a
/// translation of the camera's frame.
struct Pinhole {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  Matrix3d R = Matrix3d::Identity();
  Vector3d t{0, 0, 0};

  Vector3d center() const { return -(R.transpose() * t); }
  Vector3d in_camera(const Vector3d& point) const { return R * point + t; }
  Vector2d project(const Vector3d& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
  }
};
constexpr int kNumUnknowns = 10;
using Equations = Eigen::Matrix<double, kNumUnknowns, kNumUnknowns>;
using Unknowns = Eigen::Matrix<double, kNumUnknowns, 1>;

/// Evenly chosen points, at most some kFittedPoints.
std::vector<PixelPoint> choose_points(const PixelGrid& grid, PointsView points) {
  const auto measured = static_cast<std::size_t>(std::ranges::count_if(
      grid.point_index, [](std::int32_t i) { return i != PixelGrid::kNone; }));
  const std::size_t stride = std::max<std::size_t>(1, measured / kFittedPoints);
  std::vector<PixelPoint> chosen;
  chosen.reserve(measured / stride + 1);
  std::size_t rank = 0;
  for (std::size_t pixel = 0; pixel < grid.point_index.size(); ++pixel) {
    const std::int32_t i = grid.point_index[pixel];
    if (i == PixelGrid::kNone || rank++ % stride != 0) continue;
    chosen.push_back(
        {points[static_cast<std::size_t>(i)].cast<double>(), position_of(pixel, grid)});
  }
  return chosen;
}

/// Shift and scale that give numbers of about 1.
struct Normalization {
  Vector3d point{0, 0, 0};
  Vector2d pixel{0, 0};
  double point_scale = 1, pixel_scale = 1;
};

Normalization normalize(const std::vector<PixelPoint>& chosen) {
  Normalization n;
  const auto count = static_cast<double>(chosen.size());
  for (const PixelPoint& at : chosen) {
    n.point += at.point / count;
    n.pixel += at.pixel / count;
  }
  double points = 0, pixels = 0;
  for (const PixelPoint& at : chosen) {
    points += (at.point - n.point).squaredNorm();
    pixels += (at.pixel - n.pixel).squaredNorm();
  }
  if (points > 0) n.point_scale = std::sqrt(3 * count / points);
  if (pixels > 0) n.pixel_scale = std::sqrt(2 * count / pixels);
  return n;
}

/// The direct linear transform: the projection matrix of least algebraic distance.
Eigen::Matrix<double, 3, 4> fit_projection(const std::vector<PixelPoint>& chosen) {
  const Normalization n = normalize(chosen);
  Eigen::Matrix<double, 12, 12> A = Eigen::Matrix<double, 12, 12>::Zero();
  for (const PixelPoint& at : chosen) {
    const Eigen::Vector4d X = (n.point_scale * (at.point - n.point)).homogeneous();
    const Vector2d x = n.pixel_scale * (at.pixel - n.pixel);
    const Eigen::Matrix4d XX = X * X.transpose();
    A.block<4, 4>(0, 0) += XX;
    A.block<4, 4>(4, 4) += XX;
    A.block<4, 4>(0, 8) -= x.x() * XX;
    A.block<4, 4>(4, 8) -= x.y() * XX;
    A.block<4, 4>(8, 8) += x.squaredNorm() * XX;
  }
  A.block<4, 4>(8, 0) = A.block<4, 4>(0, 8).transpose();
  A.block<4, 4>(8, 4) = A.block<4, 4>(4, 8).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> solver(A);
  const Eigen::Matrix<double, 12, 1> p = solver.eigenvectors().col(0);
  Eigen::Matrix<double, 3, 4> P;
  for (int row = 0; row < 3; ++row) P.row(row) = p.segment<4>(4 * row).transpose();
  Eigen::Matrix4d from_points = n.point_scale * Eigen::Matrix4d::Identity();
  from_points.topRightCorner<3, 1>() = -n.point_scale * n.point;
  from_points(3, 3) = 1;
  Matrix3d to_pixels = Matrix3d::Identity() / n.pixel_scale;
  to_pixels.topRightCorner<2, 1>() = n.pixel;
  to_pixels(2, 2) = 1;
  return to_pixels * P * from_points;
}

/// Decompose P = K (R | t) by the QR decomposition of the reversed matrix; the skew is dropped.
std::optional<Pinhole> decompose(Eigen::Matrix<double, 3, 4> P) {
  if (!P.allFinite()) return std::nullopt;
  if (P.leftCols<3>().determinant() < 0) P = -P;
  Matrix3d reverse = Matrix3d::Zero();
  reverse(0, 2) = reverse(1, 1) = reverse(2, 0) = 1;
  const Matrix3d M = P.leftCols<3>();
  const Eigen::HouseholderQR<Matrix3d> qr((reverse * M).transpose());
  Matrix3d K =
      reverse * Matrix3d(qr.matrixQR().triangularView<Eigen::Upper>()).transpose() * reverse;
  Matrix3d R = reverse * Matrix3d(qr.householderQ()).transpose();
  for (int k = 0; k < 3; ++k) {
    if (K(k, k) < 0) {
      K.col(k) *= -1;
      R.row(k) *= -1;
    }
  }
  if (!(K(2, 2) > 0)) return std::nullopt;
  const Vector3d t = K.triangularView<Eigen::Upper>().solve(P.col(3));
  K /= K(2, 2);
  if (!is_focal_length(K(0, 0)) || !is_focal_length(K(1, 1)) || !(R.determinant() > 0))
    return std::nullopt;
  return Pinhole{K(0, 0), K(1, 1), K(0, 2), K(1, 2), R, t};
}

/// Derivatives of a point's two coordinates in the image.
Eigen::Matrix<double, 2, kNumUnknowns> derivative(const Pinhole& camera, const Vector3d& point) {
  const Vector3d p = camera.in_camera(point);
  const double x = p.x() / p.z(), y = p.y() / p.z();
  Eigen::Matrix<double, 2, 3> by_p;
  by_p << camera.fx / p.z(), 0, -camera.fx * x / p.z(),  //
      0, camera.fy / p.z(), -camera.fy * y / p.z();
  const Vector3d arm = p - camera.t;
  Matrix3d cross;
  cross << 0, -arm.z(), arm.y(), arm.z(), 0, -arm.x(), -arm.y(), arm.x(), 0;
  Eigen::Matrix<double, 2, kNumUnknowns> J;
  J << x, 0, 1, 0, -by_p.row(0) * cross, by_p.row(0),  //
      0, y, 0, 1, -by_p.row(1) * cross, by_p.row(1);
  return J;
}

/// A camera's fit to points: the normal equations, and the distances in the image.
struct Fit {
  Equations A = Equations::Zero();
  Unknowns b = Unknowns::Zero();
  double squares = 0, depths = 0;
  bool in_front = true;  ///< whether the camera sees all points
};

Fit fit_of(const Pinhole& camera, const std::vector<PixelPoint>& chosen) {
  Fit fit;
  for (const PixelPoint& at : chosen) {
    const Vector3d p = camera.in_camera(at.point);
    if (!(p.z() > 0)) {
      fit.in_front = false;
      return fit;
    }
    const Vector2d residual = at.pixel - camera.project(p);
    const auto J = derivative(camera, at.point);
    fit.A.noalias() += J.transpose() * J;
    fit.b.noalias() += J.transpose() * residual;
    fit.squares += residual.squaredNorm();
    fit.depths += p.z();
  }
  return fit;
}

void move(const Unknowns& step, Pinhole& camera) {
  camera.fx += step[0];
  camera.fy += step[1];
  camera.cx += step[2];
  camera.cy += step[3];
  const Vector3d turn = step.segment<3>(4);
  if (turn.norm() > 0)
    camera.R = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * camera.R;
  camera.t += step.tail<3>();
}

/// Standard deviation of the camera's place if the pixels err by `pixel_error`.
double place_error(const Pinhole& camera, const Equations& A, double pixel_error) {
  const Equations covariance = A.inverse();
  // The center is -R^T t: turning the frame by w about the camera's origin moves it by R^T (w x t).
  Matrix3d cross;
  const Vector3d& t = camera.t;
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  Eigen::Matrix<double, 3, kNumUnknowns> J = Eigen::Matrix<double, 3, kNumUnknowns>::Zero();
  J.block<3, 3>(0, 4) = -camera.R.transpose() * cross;
  J.rightCols<3>() = -camera.R.transpose();
  const double variance = (J * covariance * J.transpose()).trace();
  return variance >= 0 ? pixel_error * std::sqrt(variance)
                       : std::numeric_limits<double>::infinity();
}

/// Whether nearly all points of the scan lie within half a pixel of theirs.
bool is_image(const Pinhole& camera, const PixelGrid& grid, PointsView points) {
  double n = 0, within = 0;
  StopCheck check_stop(StopCheck::kPoints);
  for (std::size_t pixel = 0; pixel < grid.point_index.size(); ++pixel) {
    check_stop();
    const std::int32_t i = grid.point_index[pixel];
    if (i == PixelGrid::kNone) continue;
    const Vector3d p = camera.in_camera(points[static_cast<std::size_t>(i)].cast<double>());
    n += 1;
    if (!(p.z() > 0)) continue;
    const Vector2d off = camera.project(p) - position_of(pixel, grid);
    within += off.cwiseAbs().maxCoeff() < kWithin;
  }
  return within >= kShareWithin * n;
}

}  // namespace

std::optional<PosedCamera> fit_posed_camera(const PixelGrid& grid, PointsView points) {
  const std::vector<PixelPoint> chosen = choose_points(grid, points);
  const auto count = static_cast<double>(chosen.size());
  if (count < kFewestPixels) return std::nullopt;
  std::optional<Pinhole> camera = decompose(fit_projection(chosen));
  if (!camera) return std::nullopt;
  Fit fit = fit_of(*camera, chosen);
  for (int iteration = 0; iteration < kFitSteps && fit.in_front; ++iteration) {
    Pinhole moved = *camera;
    move(fit.A.ldlt().solve(fit.b), moved);
    const Fit next = fit_of(moved, chosen);
    if (!next.in_front || !(next.squares < fit.squares)) break;
    camera = moved;
    fit = next;
  }
  const double residual = std::sqrt(fit.squares / count);
  if (!fit.in_front || !is_focal_length(camera->fx) || !is_focal_length(camera->fy) ||
      !is_image(*camera, grid, points))
    return std::nullopt;
  const double error = place_error(*camera, fit.A, std::max(residual, kRounding));
  if (!(error < kLargestPlaceError * fit.depths / count)) return std::nullopt;

  PosedCamera posed{.geometry = {}, .center = camera->center(), .residual = residual};
  posed.geometry.T_camera_scene.linear() = camera->R.cast<float>();
  posed.geometry.T_camera_scene.translation() = camera->t.cast<float>();
  posed.geometry.fx = static_cast<float>(camera->fx);
  posed.geometry.fy = static_cast<float>(camera->fy);
  posed.geometry.cx = static_cast<float>(camera->cx);
  posed.geometry.cy = static_cast<float>(camera->cy);
  posed.geometry.width = grid.width;
  posed.geometry.height = grid.height;
  return posed;
}

}  // namespace trivet::kernels
