#include "kernels/verification/examine_pose.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "kernels/common/slope_fit.hpp"
#include "kernels/verification/examined_rays.hpp"
#include "kernels/verification/judge_outline.hpp"
#include "storage/common/clamped_integer.hpp"

namespace trivet::kernels {
namespace {

constexpr double kFewestResiduals = 6;  // residuals of a window needed for a slope
constexpr int kMostHalf = 4096;         // rays; half a window is unbounded
// An edge is located to about a pixel, some twice the noise of depth: squared, a quarter. It
// weights the outline's mean, since the outline's share of the pixels falls with the resolution.
constexpr double kOutlineShare = 0.25;
// A surface at a smaller height above the model may be mistaken for it [tolerances].
constexpr float kShallow = 6;
// If neighbors err alike, depth is locally wrong by a few tolerances: only measurements this much
// more than a tolerance behind the model are certain violations.
constexpr float kSoftness = 1.5F;

/// Sums over the consistent pixels and the outlines of all images.
struct Sums {
  double count = 0, squares = 0, smooth = 0, slope = 0, num_slopes = 0, area = 0;
  Matrix6 covariance = Matrix6::Zero();
  Eigen::Vector3d places = Eigen::Vector3d::Zero();  // relative to the model's center
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  OutlineSums outline;
  PoseEquations surfaces;
  EdgeEquations edges;
};

/// Variance of a pixel that counts for the rays around it: errors that neighbors share do not
/// average out within a window.
double variance_of_pixel(const ExaminedRays& rays) noexcept {
  const double side = std::max(1.0, (2 * static_cast<double>(rays.options.window) + 1) /
                                        static_cast<double>(rays.crop.stride));
  const auto own = static_cast<double>(rays.options.error),
             shared = static_cast<double>(rays.options.correlated_noise.height);
  return own * own + side * side * shared * shared;
}

/// Cast the rays, and compare what they hit with what the image measures.
void compare(const ExaminedRays& rays, std::uint32_t first_pixel, Examination& out, Sums& sums,
             ExplainedPixels* explained) {
  shoot_rays(rays.geometry, rays.crop, rays.surface, rays.T_camera_model, rays.scratch.directions,
             rays.scratch.hits);
  rays.scratch.state.assign(rays.crop.size(), kMissed);
  rays.scratch.residual.assign(rays.crop.size(), 0);
  const Eigen::Matrix3f R_camera_model = rays.T_camera_model.linear();
  const auto square = static_cast<float>(rays.crop.stride * rays.crop.stride);
  const float softness = std::max(1e-6F, kSoftness * rays.options.correlation);
  PoseEquations own;  // with a standard deviation of 1
  for (int j = 0; j < rays.crop.height; ++j) {
    for (int i = 0; i < rays.crop.width; ++i) {
      const std::size_t at = rays.crop.at(i, j);
      const float z = rays.scratch.hits.depths[at];
      if (!std::isfinite(z)) continue;
      const int u = rays.crop.u(i), v = rays.crop.v(j);
      if (!rays.inside(u, v)) {
        rays.scratch.state[at] = kOutside;
        out.outside += square;
        continue;
      }
      rays.scratch.state[at] = kJudged;
      out.covered += square;
      const Eigen::Vector3f ray = ray_through(rays.geometry, u, v);
      Eigen::Vector3f normal = (R_camera_model * rays.scratch.hits.normals[at]).normalized();
      const float length = ray.norm();
      if (normal.dot(ray) > 0) normal = -normal;
      const float facing = -normal.dot(ray) / length;
      if (!(facing > kMinRayCosine)) continue;

      const float tolerance = rays.options.verify.tolerance;
      const ExpectedPoint expected{u, v, z, length * facing};
      const auto [r, pixel] = measure_along(rays.image, expected, tolerance);
      if (pixel < 0) {
        out.unknown += square;
        rays.record(RayVerdict::unmeasured, ray * z);
        continue;
      }
      const bool background =
          rays.options.verify.is_background(rays.image.plane[static_cast<std::size_t>(pixel)]);
      if (std::abs(r) > tolerance) {
        if (measured_beside(rays.image, expected, tolerance, rays.options.edge_pixels)) continue;
        if (r > 0 || background) {  // nothing penetrates a table
          out.violation += square * std::min(1.0F, (std::abs(r) / tolerance - 1) / softness);
          rays.record(RayVerdict::looked_through, ray * z);
        } else {
          out.occluded += square;
          if (r > -kShallow * tolerance) out.sunk += square;
          rays.scratch.state[at] = kHidden;
          rays.scratch.residual[at] = r;
          rays.record(RayVerdict::hidden, ray * z);
        }
      } else if (background) {
        out.background += square;
        rays.record(RayVerdict::background, ray * z);
      } else {
        rays.scratch.state[at] = kConsistent;
        rays.scratch.residual[at] = r;
        out.consistent += square;
        rays.record(RayVerdict::agrees, ray * z);
        const double share = static_cast<double>(r / tolerance);
        sums.count += 1;
        sums.squares += share * share;
        sums.area +=
            static_cast<double>(square * z * z / (rays.geometry.fx * rays.geometry.fy * facing));
        const Eigen::Vector3d place =
            (rays.R_scene_camera * (ray * z - rays.center)).cast<double>();
        sums.places += place;
        sums.spread.noalias() += place * place.transpose();
        const Vector6 J = rays.constraint(ray * z, normal);
        own.information.noalias() += J * J.transpose();
        own.gradient -= static_cast<double>(r) * J;
        if (explained)
          explained->pixels.push_back(first_pixel +
                                      static_cast<std::uint32_t>(v) * rays.geometry.width +
                                      static_cast<std::uint32_t>(u));
      }
    }
  }
  sums.covariance += own.information;
  if (!(rays.options.error > 0)) return;  // no equations are wanted
  const double weight = 1 / variance_of_pixel(rays);
  sums.surfaces.information += weight * own.information;
  sums.surfaces.gradient += weight * own.gradient;
}

/// Summed-area table of 1, r, x, y, xx, yy, xy, rx and ry over consistent pixels.
void sum_up(const ExaminedRays& rays) {
  const std::size_t row = static_cast<std::size_t>(rays.crop.width) + 1;
  rays.scratch.sums.assign(row * (static_cast<std::size_t>(rays.crop.height) + 1), {});
  for (int j = 0; j < rays.crop.height; ++j) {
    std::array<double, 9> line{};
    for (int i = 0; i < rays.crop.width; ++i) {
      const std::size_t at = rays.crop.at(i, j);
      if (rays.scratch.state[at] == kConsistent) {
        const double r = static_cast<double>(rays.scratch.residual[at]), x = i, y = j;
        const std::array<double, 9> add{1, r, x, y, x * x, y * y, x * y, r * x, r * y};
        for (std::size_t k = 0; k < 9; ++k) line[k] += add[k];
      }
      const std::size_t below =
          (static_cast<std::size_t>(j) + 1) * row + static_cast<std::size_t>(i) + 1;
      for (std::size_t k = 0; k < 9; ++k)
        rays.scratch.sums[below][k] = rays.scratch.sums[below - row][k] + line[k];
    }
  }
}

std::array<double, 9> window_sums(const ExaminedRays& rays, int i0, int j0, int i1,
                                  int j1) noexcept {
  const std::size_t row = static_cast<std::size_t>(rays.crop.width) + 1;
  const auto at = [&](int i, int j) -> const std::array<double, 9>& {
    return rays.scratch.sums[static_cast<std::size_t>(j) * row + static_cast<std::size_t>(i)];
  };
  std::array<double, 9> sum;
  for (std::size_t k = 0; k < 9; ++k)
    sum[k] = at(i1 + 1, j1 + 1)[k] - at(i0, j1 + 1)[k] - at(i1 + 1, j0)[k] + at(i0, j0)[k];
  return sum;
}

/// Average the residuals over windows, and fit planes to them.
void smooth(const ExaminedRays& rays, Sums& sums) {
  sum_up(rays);
  const int half = clamped_integer(
      std::round(rays.options.window / static_cast<float>(rays.crop.stride)), 1, kMostHalf);
  const double tolerance = static_cast<double>(rays.options.verify.tolerance);
  for (int j = 0; j < rays.crop.height; ++j) {
    for (int i = 0; i < rays.crop.width; ++i) {
      const std::size_t at = rays.crop.at(i, j);
      if (rays.scratch.state[at] != kConsistent) continue;
      const std::array<double, 9> w = window_sums(
          rays, std::max(0, i - half), std::max(0, j - half),
          std::min(rays.crop.width - 1, i + half), std::min(rays.crop.height - 1, j + half));
      const double n = w[0], mean = w[1] / n;
      sums.smooth += mean * mean / (tolerance * tolerance);
      if (n < kFewestResiduals) continue;
      const SlopeFit fit = fit_slope({n, w[2], w[3], w[4], w[6], w[5], w[1], w[7], w[8]});
      if (!(fit.determinant > 1e-3 * n * n)) continue;
      const double step = static_cast<double>(rays.scratch.hits.depths[at] / rays.geometry.fx *
                                              static_cast<float>(rays.crop.stride));
      sums.slope += std::atan(std::sqrt(fit.gx * fit.gx + fit.gy * fit.gy) / step);
      sums.num_slopes += 1;
    }
  }
}

/// Effect of rotation about the symmetry axis on J, as a unit vector; zero without an axis.
Vector6 free_turn(const PosedModel& model,
                  const std::optional<Symmetry::Axis>& free_axis) noexcept {
  Vector6 turn = Vector6::Zero();
  if (!free_axis) return turn;
  const Pose& T_scene_model = model.T_scene_model;
  const Eigen::Vector3f axis = T_scene_model.linear() * free_axis->direction;
  const Eigen::Vector3f arm =
      T_scene_model * model.samples.center - T_scene_model * Eigen::Vector3f(free_axis->point);
  turn << axis.cast<double>(), (axis.cross(arm) / (0.5F * model.samples.diameter)).cast<double>();
  return turn.normalized();
}

/// Standard deviation of the consistent points from their best-fit plane.
float off_plane(const Sums& sums) {
  const Eigen::Vector3d mean = sums.places / sums.count;
  const Eigen::Matrix3d spread = sums.spread / sums.count - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread, Eigen::EigenvaluesOnly);
  return static_cast<float>(std::sqrt(std::max(0.0, solver.eigenvalues()(0))));
}

}  // namespace

Examination examine_pose(std::span<const RangeImage> images, const PosedModel& model,
                         const std::optional<Symmetry::Axis>& free_axis,
                         const ExamineOptions& options, ExamineScratch& scratch,
                         const ExamineLists& lists) {
  const auto [explained, rays, equations] = lists;
  if (explained) *explained = {};
  if (rays) rays->clear();
  const ModelSamples& samples = model.samples;
  Examination out;
  const float radius = 0.5F * ball_diameter(samples);
  Sums sums;
  std::uint32_t first_pixel = 0;
  for (const RangeImage& image : images) {
    const std::optional<PixelBox> box = project_ball(
        image.geometry, image.geometry.T_camera_scene * (model.T_scene_model * samples.center),
        radius);
    if (box) {
      const ExaminedRays cast(image, model, *box, options, scratch, rays);
      compare(cast, first_pixel, out, sums, explained);
      smooth(cast, sums);
      judge_outline(cast, out, sums.outline, equations ? &sums.edges : nullptr);
      if (explained) explained->square = static_cast<std::uint32_t>(cast.crop.stride);
    }
    first_pixel += static_cast<std::uint32_t>(image.depth.size());
  }
  if (equations) {
    *equations = sums.surfaces;
    sums.edges.add_to(*equations);
  }
  if (sums.count == 0) return out;
  const float shared = options.correlated_noise.height / options.verify.tolerance;
  const auto beyond = [](double squares, float expected) {
    return std::max(0.0F, static_cast<float>(squares) - expected * expected);
  };
  out.mean_square = static_cast<float>(sums.squares / sums.count);
  out.residual = beyond(sums.squares / sums.count, shared);
  out.smooth = beyond(sums.smooth / sums.count, shared);
  const double slope = sums.slope / std::max(1.0, sums.num_slopes);
  out.slope = std::sqrt(beyond(slope * slope, options.correlated_noise.slope_rad));
  out.area = static_cast<float>(sums.area) / (samples.diameter * samples.diameter);
  out.relief = off_plane(sums) / options.verify.tolerance;
  const Vector6 turn = free_turn(model, free_axis);
  Matrix6 held = sums.covariance / sums.count + turn * turn.transpose();
  if (sums.outline.count > 0) held += kOutlineShare / sums.outline.count * sums.outline.covariance;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(held, Eigen::EigenvaluesOnly);
  out.stability = static_cast<float>(std::max(0.0, solver.eigenvalues()(0)));
  return out;
}

}  // namespace trivet::kernels
