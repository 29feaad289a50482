#include "kernels/verification/examine_pose.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "kernels/common/slope_fit.hpp"
#include "kernels/verification/examined_rays.hpp"
#include "kernels/verification/expected_depths.hpp"
#include "kernels/verification/judge_outline.hpp"
#include "storage/common/clamped_integer.hpp"

namespace trivet::kernels {
namespace {

// If the mean of 1 / n over windows of n residuals is larger, their means are no evidence of what
// residuals share.
constexpr double kMostPart = 0.5;
constexpr double kFewestResiduals = 6;  // residuals of a window needed for a slope
// The tolerance in standard deviations of residuals, which are measured by a quantile: few of a right
// pose's lie beyond, beside edges or beneath things on it, and depths of coarse steps have a median
// of 0.
constexpr float kDeviations = 5;
constexpr float kQuantile = 0.8F, kQuantileDeviations = 1.2816F;  // of a normal distribution
constexpr std::size_t kFewestDistances = 30;                      // for a standard deviation
constexpr int kMostHalf = 4096;  // rays; half a window is unbounded
// An edge is located to about a pixel, some twice the noise of depth: squared, a quarter. It
// weights the outline's mean, since the outline's share of the pixels falls with the resolution.
constexpr double kOutlineShare = 0.25;
// A surface at a smaller height above the model may be mistaken for it [tolerances].
constexpr float kShallow = 6;
// What is measured so far behind the model is neither its surface nor an error [tolerances].
constexpr float kFarBehind = 6;
// If neighbors err alike, depth is locally wrong by a few tolerances: only measurements this much
// more than a tolerance behind the model are certain violations.
constexpr float kSoftness = 1.5F;
// Depth is measured over the width of a pixel, and what an oblique surface has there depends on where
// in it: the rays err sideways by half a pixel.
constexpr double kSidewaysError = 0.5;
// Weight of rays on a face that is but one ray wide, as the side of a sheet is: in the blur of an edge
// they do not err independently.
constexpr double kNarrowWeight = 0.3;
constexpr float kSameFace = 0.75F;  // squared cosine of 30 degrees, between neighbors' normals

/// Sums over the consistent pixels and the outlines of all images.
struct Sums {
  double count = 0, squares = 0, shifts = 0, smooth = 0, parts_of_windows = 0, slope = 0,
         num_slopes = 0, area = 0;
  Matrix6 covariance = Matrix6::Zero();
  Eigen::Vector3d places = Eigen::Vector3d::Zero();  // relative to the model's center
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  OutlineSums outline;
  PoseEquations surfaces;
  EdgeEquations edges;
};

/// Variance of a pixel that counts for the rays around it, across a surface that faces the sensor:
/// errors that neighbors share do not average out within a window.
double variance_facing(const ExaminedRays& rays) noexcept {
  const double side = std::max(1.0, (2 * static_cast<double>(rays.options.window) + 1) /
                                        static_cast<double>(rays.crop.stride));
  const auto own = static_cast<double>(rays.options.error),
             shared = static_cast<double>(rays.options.correlated_noise.height);
  return own * own + side * side * shared * shared;
}

/// Whether a ray meets a face that is at least two rays wide and high.
bool is_on_wide_face(const ExaminedRays& rays, int i, int j) noexcept {
  const Eigen::Vector3f normal = rays.hits.normals[rays.crop.at(i, j)];
  const auto goes_on_at = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= rays.crop.width || y >= rays.crop.height) return false;
    const std::size_t at = rays.crop.at(x, y);
    if (!std::isfinite(rays.hits.depths[at])) return false;
    const Eigen::Vector3f other = rays.hits.normals[at];
    const float product = normal.dot(other);
    return product * product > kSameFace * normal.squaredNorm() * other.squaredNorm();
  };
  return (goes_on_at(i - 1, j) || goes_on_at(i + 1, j)) &&
         (goes_on_at(i, j - 1) || goes_on_at(i, j + 1));
}

/// Append the residuals of the measurements that agree with the model by the largest tolerance.
void collect_distances(const ExaminedRays& rays, Column<float>& distances) {
  const float tolerance = rays.options.verify.tolerance;
  for (int j = 0; j < rays.crop.height; ++j) {
    for (int i = 0; i < rays.crop.width; ++i) {
      const float z = rays.expected[rays.crop.at(i, j)];
      const int u = rays.crop.u(i), v = rays.crop.v(j);
      if (!std::isfinite(z) || !rays.inside(u, v)) continue;
      const RayHit hit = rays.hit_at(i, j);
      if (!(hit.facing > kMinRayCosine)) continue;
      const auto [r, pixel] =
          measure_along(rays.image, {u, v, z, hit.length * hit.facing}, tolerance);
      if (pixel < 0 || std::abs(r) > tolerance) continue;
      if (rays.options.verify.is_background(rays.image.plane[static_cast<std::size_t>(pixel)]))
        continue;
      distances.push_back(std::abs(r));
    }
  }
}

/// Whether the residuals of a pose may lower the tolerance.
bool may_lower(const ExamineOptions& options) noexcept {
  return options.least_tolerance > 0 && options.least_tolerance < options.verify.tolerance;
}

/// The tolerance by the residuals of a pose: what the sensor and the model leave at the right one.
float own_tolerance(const ExamineOptions& options, Column<float>& distances) noexcept {
  if (distances.size() < kFewestDistances) return options.verify.tolerance;
  const auto at = distances.begin() +
                  static_cast<std::ptrdiff_t>(kQuantile * static_cast<float>(distances.size()));
  std::nth_element(distances.begin(), at, distances.end());
  const float deviation = *at / kQuantileDeviations;
  return std::clamp(kDeviations * deviation, options.least_tolerance, options.verify.tolerance);
}

/// Compare what the rays hit with what the image measures.
void compare(const ExaminedRays& rays, float largest_tolerance, std::uint32_t first_pixel,
             Examination& out, Sums& sums, ExplainedPixels* explained) {
  rays.scratch.state.assign(rays.crop.size(), kMissed);
  rays.scratch.residual.assign(rays.crop.size(), 0);
  const auto square = static_cast<float>(rays.crop.stride * rays.crop.stride);
  const float softness = std::max(1e-6F, kSoftness * rays.options.correlation);
  const std::uint8_t bearing = rays.options.verify.bearing_plane;
  Matrix6 own = Matrix6::Zero();
  PoseEquations within;  // the rays within the largest tolerance count for `information`
  const double variance = variance_facing(rays);
  for (int j = 0; j < rays.crop.height; ++j) {
    for (int i = 0; i < rays.crop.width; ++i) {
      const std::size_t at = rays.crop.at(i, j);
      const float z = rays.hits.depths[at];
      if (!std::isfinite(z)) continue;
      const int u = rays.crop.u(i), v = rays.crop.v(j);
      if (!rays.inside(u, v)) {
        rays.scratch.state[at] = kOutside;
        out.outside += square;
        continue;
      }
      rays.scratch.state[at] = kJudged;
      out.covered += square;
      const RayHit hit = rays.hit_at(i, j);
      if (!(hit.facing > kMinRayCosine)) continue;

      const float tolerance = rays.options.verify.tolerance;
      const ExpectedPoint expected{u, v, rays.expected[at], hit.length * hit.facing};
      const auto [r, pixel] = measure_along(rays.image, expected, tolerance);
      if (pixel < 0) {
        out.unknown += square;
        rays.scratch.state[at] = kUnmeasured;
        rays.record(RayVerdict::unmeasured, hit.place);
        continue;
      }
      const std::uint8_t plane = rays.image.plane[static_cast<std::size_t>(pixel)];
      const bool background = rays.options.verify.is_background(plane);
      Vector6 J;  // of rays that hold the pose
      double weight = 0;
      if (!background && std::abs(r) <= largest_tolerance) {
        const double share = static_cast<double>(r / largest_tolerance);
        const double robust = (1 - share * share) * (1 - share * share);  // Tukey
        const double sideways = kSidewaysError * static_cast<double>(z / rays.geometry.fx);
        const auto facing = static_cast<double>(hit.facing);
        weight = 1 / (variance + sideways * sideways * (1 - facing * facing));
        if (!is_on_wide_face(rays, i, j)) weight *= kNarrowWeight;
        J = rays.constraint(hit.place, hit.normal);
        within.information.noalias() += robust * weight * J * J.transpose();
        within.gradient -= robust * weight * static_cast<double>(r) * J;
      }
      if (std::abs(r) > tolerance) {
        if (measured_beside(rays.image, expected, tolerance, rays.options.edge_pixels)) continue;
        if (r > 0 || rays.options.verify.is_solid(plane)) {  // nothing penetrates a table
          out.violation += square * std::min(1.0F, (std::abs(r) / tolerance - 1) / softness);
          if (r > kFarBehind * tolerance) rays.scratch.state[at] = kSeenThrough;
          rays.record(RayVerdict::looked_through, hit.place);
        } else {
          out.occluded += square;
          const bool entered =
              bearing > 0 && rays.image.near_plane[static_cast<std::size_t>(pixel)] == bearing;
          rays.scratch.state[at] = entered ? kEntered : kHidden;
          if (!entered && r > -kShallow * tolerance) out.sunk += square;
          rays.scratch.residual[at] = r;
          rays.record(RayVerdict::hidden, hit.place);
        }
      } else if (background) {
        out.background += square;
        rays.record(RayVerdict::background, hit.place);
      } else {
        rays.scratch.state[at] = kConsistent;
        rays.scratch.residual[at] = r;
        out.consistent += square;
        rays.record(RayVerdict::agrees, hit.place);
        const double share = static_cast<double>(r / tolerance);
        sums.count += 1;
        sums.squares += share * share;
        const auto shift = static_cast<double>((rays.expected[at] - z) * expected.scale);
        sums.shifts += shift * shift;
        sums.area += static_cast<double>(square * z * z /
                                         (rays.geometry.fx * rays.geometry.fy * hit.facing));
        const Eigen::Vector3d place =
            (rays.R_scene_camera * (hit.place - rays.center)).cast<double>();
        sums.places += place;
        sums.spread.noalias() += place * place.transpose();
        own.noalias() += J * J.transpose();
        within.held.noalias() += weight * J * J.transpose();
        if (explained)
          explained->pixels.push_back(first_pixel +
                                      static_cast<std::uint32_t>(v) * rays.geometry.width +
                                      static_cast<std::uint32_t>(u));
      }
    }
  }
  sums.covariance += own;
  if (!(rays.options.error > 0)) return;  // no equations are wanted
  sums.surfaces.held += within.held;
  sums.surfaces.information += within.information;
  sums.surfaces.gradient += within.gradient;
}

/// The area of the squares of rays that are all as a test says, each wider than the blur of an
/// outline on both of its sides: outlines are up to a pixel, and the shift of the scan's, beside
/// their place. A square counts for the pixels of one ray.
template <class IsSo>
float area_of_squares(const ExaminedRays& rays, const IsSo& is_so) noexcept {
  const int stride = rays.crop.stride;
  const int side = 2 + 2 * (rays.options.edge_pixels + 1) / stride;  // rays
  const auto is_all_so = [&](int i, int j) {
    for (int y = j; y < j + side; ++y) {
      for (int x = i; x < i + side; ++x) {
        if (!is_so(x, y)) return false;
      }
    }
    return true;
  };
  float area = 0;
  for (int j = 0; j + side <= rays.crop.height; ++j) {
    for (int i = 0; i + side <= rays.crop.width; ++i) {
      if (is_all_so(i, j)) area += static_cast<float>(stride * stride);
    }
  }
  return area;
}

/// Whether the next ray in a direction that was measured agrees with the model.
bool agrees_next(const ExaminedRays& rays, int i, int j, int di, int dj) noexcept {
  for (int x = i + di, y = j + dj; x >= 0 && y >= 0 && x < rays.crop.width && y < rays.crop.height;
       x += di, y += dj) {
    const std::uint8_t state = rays.scratch.state[rays.crop.at(x, y)];
    if (state == kConsistent) return true;
    if (state != kUnmeasured && state != kJudged) return false;  // grazing rays judge nothing
  }
  return false;
}

/// Count what was not measured between rays that agree: shiny and dark surfaces have such gaps.
void find_gaps(const ExaminedRays& rays, Examination& out) noexcept {
  for (int j = 0; j < rays.crop.height; ++j) {
    for (int i = 0; i < rays.crop.width; ++i) {
      if (rays.scratch.state[rays.crop.at(i, j)] != kUnmeasured) continue;
      if ((agrees_next(rays, i, j, 1, 0) && agrees_next(rays, i, j, -1, 0)) ||
          (agrees_next(rays, i, j, 0, 1) && agrees_next(rays, i, j, 0, -1)))
        out.gaps += static_cast<float>(rays.crop.stride * rays.crop.stride);
    }
  }
}

/// Find what lies on the model, and where the sensor saw through it, wider than outlines are blurred.
void find_wide(const ExaminedRays& rays, Examination& out) noexcept {
  // A grazing surface is not judged, but what is a step before it hides it, too.
  out.overlaid += area_of_squares(rays, [&](int i, int j) {
    const std::uint8_t state = rays.scratch.state[rays.crop.at(i, j)];
    if (state != kJudged) return state == kHidden;
    const std::size_t pixel = rays.pixel_at(rays.crop.u(i), rays.crop.v(j));
    const float d = rays.image.depth[pixel];
    return d > 0 && d < rays.depth_at(i, j) - rays.jump &&
           !rays.options.verify.is_background(rays.image.near_plane[pixel]);
  });
  out.seen_through += area_of_squares(
      rays, [&](int i, int j) { return rays.scratch.state[rays.crop.at(i, j)] == kSeenThrough; });
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
      sums.parts_of_windows += 1 / n;
      if (n < kFewestResiduals) continue;
      const SlopeFit fit = fit_slope({n, w[2], w[3], w[4], w[6], w[5], w[1], w[7], w[8]});
      if (!(fit.determinant > 1e-3 * n * n)) continue;
      const double step = static_cast<double>(rays.hits.depths[at] / rays.geometry.fx *
                                              static_cast<float>(rays.crop.stride));
      sums.slope += std::atan(std::sqrt(fit.gx * fit.gx + fit.gy * fit.gy) / step);
      sums.num_slopes += 1;
    }
  }
}

/// Variance that the residuals of a window share, in squared tolerances. The squared mean of n
/// residuals is on average that variance and an n-th of what is independent. Source: Searle, Casella
/// and McCulloch, Variance Components, 1992 (one-way classification).
double shared_variance(const Sums& sums) noexcept {
  const double part = sums.parts_of_windows / sums.count;
  if (!(part < kMostPart)) return 0;
  return std::max(0.0, (sums.smooth - part * sums.squares) / sums.count / (1 - part));
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
  if (lists.explained) *lists.explained = {};
  if (lists.rays) lists.rays->clear();
  const ModelSamples& samples = model.samples;
  Examination out;
  const float radius = 0.5F * ball_diameter(samples);
  Sums sums;
  const bool is_smoothed = options.smoothing > 0;
  /// Call `body` with the rays at the model in each image that may show it, and the image's index.
  const auto each_crop = [&](const ExamineOptions& how, auto&& body) {
    for (std::size_t k = 0; k < images.size(); ++k) {
      const ImageGeometry& geometry = images[k].geometry;
      const std::optional<PixelBox> box = project_ball(
          geometry, geometry.T_camera_scene * (model.T_scene_model * samples.center), radius);
      if (box)
        body(ExaminedRays(images[k], model, *box, how, scratch, scratch.hits[k],
                          is_smoothed ? scratch.expected[k] : scratch.hits[k].depths, lists.rays),
             k);
    }
  };
  scratch.hits.resize(std::max(scratch.hits.size(), images.size()));
  scratch.expected.resize(scratch.hits.size());
  scratch.distances.clear();
  each_crop(options, [&](const ExaminedRays& cast, std::size_t k) {
    shoot_rays(cast.geometry, cast.crop, cast.surface, cast.T_camera_model, scratch.directions,
               scratch.hits[k]);
    if (is_smoothed)
      expect_depths(cast.image, cast.crop, cast.hits, options.smoothing, scratch.scene,
                    scratch.expected[k]);
    if (may_lower(options)) collect_distances(cast, scratch.distances);
  });
  ExamineOptions judged = options;
  out.tolerance = judged.verify.tolerance = own_tolerance(options, scratch.distances);
  each_crop(judged, [&](const ExaminedRays& cast, std::size_t k) {
    std::size_t first_pixel = 0;
    for (const RangeImage& before : images.first(k)) first_pixel += before.depth.size();
    compare(cast, options.verify.tolerance, static_cast<std::uint32_t>(first_pixel), out, sums,
            lists.explained);
    find_wide(cast, out);
    find_gaps(cast, out);
    smooth(cast, sums);
    judge_outline(cast, out, sums.outline, lists.equations ? &sums.edges : nullptr);
    if (lists.explained) lists.explained->square = static_cast<std::uint32_t>(cast.crop.stride);
  });
  if (lists.equations) {
    *lists.equations = sums.surfaces;
    sums.edges.add_to(*lists.equations);
  }
  if (sums.count == 0) return out;
  const float shared = options.correlated_noise.height / out.tolerance;
  const auto beyond = [](double squares, float expected) {
    return std::max(0.0F, static_cast<float>(squares) - expected * expected);
  };
  out.mean_square = static_cast<float>(sums.squares / sums.count);
  out.residual = beyond(sums.squares / sums.count, shared);
  out.smooth = beyond(sums.smooth / sums.count, shared);
  out.deviation = std::sqrt(beyond(shared_variance(sums), shared)) * out.tolerance;
  const double slope = sums.slope / std::max(1.0, sums.num_slopes);
  out.slope = std::sqrt(beyond(slope * slope, options.correlated_noise.slope_rad));
  out.area = static_cast<float>(sums.area) / (samples.diameter * samples.diameter);
  out.relief = off_plane(sums) / out.tolerance;
  out.smoothing_shift = static_cast<float>(std::sqrt(sums.shifts / sums.count));
  const Vector6 turn = free_turn(model, free_axis);
  Matrix6 held = sums.covariance / sums.count + turn * turn.transpose();
  if (sums.outline.count > 0) held += kOutlineShare / sums.outline.count * sums.outline.covariance;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(held, Eigen::EigenvaluesOnly);
  out.stability = static_cast<float>(std::max(0.0, solver.eigenvalues()(0)));
  return out;
}

}  // namespace trivet::kernels
