/// Slow reference implementation of the examination of a pose: in double precision, ray by ray and
/// window by window.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "kernels/common/ray_scene.hpp"
#include "kernels/scans/range_image.hpp"
#include "storage/data/model.hpp"
#include "support/reference_matrices.hpp"

namespace trivet::reference {

struct Examination {
  double covered = 0, outside = 0, consistent = 0, violation = 0, occluded = 0, sunk = 0,
         unknown = 0, background = 0;
  double residual = 0, smooth = 0, deviation = 0, slope = 0, area = 0, relief = 0, stability = 0;
  double beside = 0;  // fraction of covered pixels seen beside their place: not counted
};

/// examine_pose as documented, for one image whose plane 1 is background, a window of 2 pixels, and
/// rays that are `square` pixels apart around the center of the model's image. The outlines of the
/// scan are up to `edge` pixels beside their place.
inline Examination examination(const kernels::RangeImage& image, const kernels::RayScene& surface,
                               float diameter, const Pose& T_camera_model, std::uint32_t square,
                               float tolerance, int edge, double correlation) {
  const kernels::ImageGeometry& g = image.geometry;
  const int width = static_cast<int>(g.width), height = static_cast<int>(g.height);
  const int stride = static_cast<int>(square);
  const Pose T_model_camera = T_camera_model.inverse();
  const Eigen::Vector3d center = T_camera_model.translation().cast<double>();
  const auto middle = [&](float f, double at, float c) {
    return static_cast<int>(
        std::floor(static_cast<double>(f) * at / center.z() + static_cast<double>(c)));
  };
  const int u_middle = middle(g.fx, center.x(), g.cx), v_middle = middle(g.fy, center.y(), g.cy);
  const double each = stride * stride, tau = static_cast<double>(tolerance);

  Examination out;
  std::map<std::pair<int, int>, double> residuals;  // keyed by steps from the center
  std::map<std::pair<int, int>, double> depths;
  std::vector<Eigen::Vector3d> places;         // places that agree
  std::map<std::pair<int, int>, double> hits;  // all rays that hit the model
  std::map<std::pair<int, int>, bool> edges;   // those inside the image that nothing occludes
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  const auto inside = [&](int x, int y) { return x >= 0 && y >= 0 && x < width && y < height; };
  const int reach = 400 / stride;
  for (int j = -reach; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      const int u = u_middle + stride * i, v = v_middle + stride * j;
      const Eigen::Vector3f ray_f((static_cast<float>(u) - g.cx) / g.fx,
                                  (static_cast<float>(v) - g.cy) / g.fy, 1);
      const kernels::Hit hit =
          surface.intersect(T_model_camera.translation(), T_model_camera.linear() * ray_f, 0,
                            std::numeric_limits<float>::infinity());
      if (!hit) continue;
      hits[{i, j}] = static_cast<double>(hit.distance);
      if (!inside(u, v)) {
        out.outside += each;
        continue;
      }
      out.covered += each;
      edges[{i, j}] = true;
      const Eigen::Vector3d ray = ray_f.cast<double>();
      Eigen::Vector3d n = (T_camera_model.linear() * hit.normal).cast<double>();
      if (n.dot(ray) > 0) n = -n;
      const double facing = -n.dot(ray) / ray.norm(), z = static_cast<double>(hit.distance);
      if (facing <= 0.17) continue;
      double best = std::numeric_limits<double>::infinity();
      bool background = false;
      const int cross[5][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}};
      for (const auto& [du, dv] : cross) {
        if (!inside(u + du, v + dv)) continue;
        const auto pixel = static_cast<std::size_t>((v + dv) * width + u + du);
        const double d = static_cast<double>(image.depth[pixel]);
        if (!(d > 0)) continue;
        const double r = (d - z) * ray.norm() * facing;
        if (std::abs(r) < std::abs(best)) {
          best = r;
          background = image.plane[pixel] == 1;
        }
        if (du == 0 && dv == 0 && std::abs(r) <= tau) break;
      }
      bool beside = false;
      for (int step = 2; step <= edge; ++step) {
        for (int dv = -step; dv <= step; dv += step) {
          for (int du = -step; du <= step; du += step) {
            if (!inside(u + du, v + dv)) continue;
            const double d = static_cast<double>(
                image.depth[static_cast<std::size_t>((v + dv) * width + u + du)]);
            beside = beside || (d > 0 && std::abs(d - z) * ray.norm() * facing <= tau);
          }
        }
      }
      // Beyond the tolerance, the weight of a violation increases, up to 1.5 correlations beyond
      // it.
      const double beyond = std::abs(best) / tau - 1;
      const double share = beyond < 1.5 * correlation ? beyond / (1.5 * correlation) : 1;
      if (!std::isfinite(best)) {
        out.unknown += each;
      } else if (beyond > 0 && beside) {
        out.beside += each;
      } else if (best > tau) {
        out.violation += each * share;
      } else if (best < -tau) {
        if (background)
          out.violation += each * share;
        else
          out.occluded += each;
        if (!background && best > -6 * tau) out.sunk += each;
        edges[{i, j}] = background;
      } else if (background) {
        out.background += each;
      } else {
        out.consistent += each;
        residuals[{i, j}] = best;
        depths[{i, j}] = z;
        out.residual += best * best / (tau * tau);
        out.area += each * z * z / static_cast<double>(g.fx * g.fy) / facing;
        places.push_back(ray * z);
        const Eigen::Vector3d arm = (ray * z - center) / (static_cast<double>(diameter) / 2);
        Eigen::Matrix<double, 6, 1> J;
        J << arm.cross(n), n;
        A += J * J.transpose();
      }
    }
  }
  if (residuals.empty()) return out;
  const auto count = static_cast<double>(residuals.size());
  out.residual /= count;
  Eigen::Vector3d middle_of_all = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& place : places) middle_of_all += place / count;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& place : places)
    scatter += (place - middle_of_all) * (place - middle_of_all).transpose() / count;
  if (places.size() >= 3)
    out.relief = std::sqrt(std::max(0.0, eigen_system(scatter).values(0))) / tau;
  out.area /= static_cast<double>(diameter) * static_cast<double>(diameter);

  // The outline: pixels where the model was seen up to its end, with something farther all around
  // beyond it.
  Eigen::Matrix<double, 6, 6> B = Eigen::Matrix<double, 6, 6>::Zero();
  double outline = 0;
  const double size = static_cast<double>(diameter), fx = static_cast<double>(g.fx);
  const double jump = std::max(2 * tau, 0.03 * size);
  for (const auto& [at, shown] : edges) {
    if (!shown) continue;
    const auto [i, j] = at;
    const double z = hits[at];
    const int blur = stride - 1 + std::max({3, edge + 1, static_cast<int>(0.03 * size * fx / z)});
    Eigen::Vector2d across(0, 0), farther(0, 0);
    for (int dj = -3; dj <= 3; ++dj) {
      for (int di = -3; di <= 3; ++di) {
        const int u = u_middle + stride * (i + di), v = v_middle + stride * (j + dj);
        if (di * di + dj * dj > 10 || hits.contains({i + di, j + dj})) continue;
        across += Eigen::Vector2d(di, dj);
        if (!inside(u, v)) continue;
        if (static_cast<double>(image.depth[static_cast<std::size_t>(v * width + u)]) > z + jump)
          farther += Eigen::Vector2d(di, dj);
      }
    }
    const bool is_determined =
        across.norm() * farther.norm() > 0 && across.normalized().dot(farther.normalized()) > 0.985;
    if (is_determined) across.normalize();
    const int steps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    for (const auto& [di, dj] : steps) {
      bool ends = true, free = false, agrees = false;
      for (int k = 1; k <= 4; ++k) ends = ends && !hits.contains({i + k * di, j + k * dj});
      if (!ends) continue;
      outline += 1;
      for (int k = 1; k <= blur; ++k) {
        const int u = u_middle + stride * i + k * di, v = v_middle + stride * j + k * dj;
        if (!inside(u, v)) break;
        const double d = static_cast<double>(image.depth[static_cast<std::size_t>(v * width + u)]);
        free = free || !(d > 0) || d > z + jump;
      }
      for (int k = 0; k * stride <= blur; ++k)
        agrees = agrees || residuals.contains({i - k * di, j - k * dj});
      if (!is_determined || !free || !agrees) continue;
      // The plane through the camera that contains the outline.
      const Eigen::Vector3d ray(
          (u_middle + stride * i - static_cast<double>(g.cx)) / fx,
          (v_middle + stride * j - static_cast<double>(g.cy)) / static_cast<double>(g.fy), 1);
      const Eigen::Vector3d along(-across.y() / fx, across.x() / static_cast<double>(g.fy), 0);
      const Eigen::Vector3d n = along.cross(ray).normalized();
      const Eigen::Vector3d arm = (ray * z - center) / (size / 2);
      Eigen::Matrix<double, 6, 1> J;
      J << arm.cross(n), n;
      B += J * J.transpose();
    }
  }
  if (outline > 0) A += 0.25 * count / outline * B;
  out.stability = least_eigenvalue(A / count);

  const int half = std::max(1, static_cast<int>(std::lround(2.0 / stride)));
  double num_slopes = 0, parts = 0;
  for (const auto& [at, r] : residuals) {
    Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();  // sums of least squares, a + b di + c dj
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (int dj = -half; dj <= half; ++dj) {
      for (int di = -half; di <= half; ++di) {
        const auto found = residuals.find({at.first + di, at.second + dj});
        if (found == residuals.end()) continue;
        const Eigen::Vector3d row(1, di, dj);
        sums += row * row.transpose();
        right += found->second * row;
      }
    }
    const double n = sums(0, 0), mean = right(0) / n;
    out.smooth += mean * mean / (tau * tau) / count;
    parts += 1 / n / count;
    if (n < 6) continue;
    const Eigen::Vector2d middle_step = sums.block<2, 1>(1, 0) / n;
    const Eigen::Matrix2d centered =
        sums.block<2, 2>(1, 1) - n * middle_step * middle_step.transpose();
    if (!(centered.determinant() > 1e-3 * n * n)) continue;
    const Eigen::Vector3d plane = sums.inverse() * right;
    const double step = depths[at] / static_cast<double>(g.fx) * stride;
    out.slope += std::atan(plane.tail<2>().norm() / step);
    num_slopes += 1;
  }
  out.slope /= std::max(1.0, num_slopes);
  // The residuals' variance is that of windows plus that within them, which averages out by parts.
  if (parts < 0.5)
    out.deviation = std::sqrt(std::max(0.0, out.smooth - parts * out.residual) / (1 - parts)) * tau;
  return out;
}

}  // namespace trivet::reference
