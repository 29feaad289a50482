#include "kernels/verification/compare_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace trivet::kernels {
namespace {

constexpr float kFitError = 0.004F;      // error of model and pose, relative to the diameter
constexpr double kAgreement = 10;        // likelihood ratio of r = 0 to a pixel off the model
constexpr double kBehindSurface = 0.03;  // likelihood ratio of a measurement anywhere behind the
                                         // surface
// If neighbors err alike, this share of the surface is blended with its surroundings, as thin parts
// and edges are, and its errors are larger by this factor.
constexpr double kBlended = 0.3, kBlend = 8;
// Rays needed to estimate the share without measurement, and the smallest such share.
constexpr double kFewestRays = 50, kFewHoles = 0.02;

/// One pose's rendering of one ray.
struct Rendered {
  bool meets = false;
  float z = 0;
  float facing = 0;  // cosine between the ray and the normal
  float scale = 0;   // perpendicular distance per depth; 0 for a grazing surface
};

Rendered render(const RayHits& hits, std::size_t at, const Eigen::Matrix3f& R,
                const Eigen::Vector3f& ray) noexcept {
  const float z = hits.depths[at];
  if (!std::isfinite(z)) return {};
  const float length = ray.norm();
  const float facing = std::abs((R * hits.normals[at]).dot(ray)) / length;
  return {true, z, facing, facing > kMinRayCosine ? facing * length : 0};
}

class Comparer {
 public:
  Comparer(const RangeImage& image, float sigma, float correlation, const VerifyOptions& options)
      : image_(image),
        options_(options),
        sigma_(static_cast<double>(sigma)),
        blended_(kBlended * static_cast<double>(correlation)) {}

  bool is_missing(int u, int v) const noexcept {
    return measure_along(image_, {u, v, 1, 1}, 0).pixel < 0;
  }

  /// Whether the renderings of the poses differ here.
  bool differ(const Rendered& a, const Rendered& b, int u, int v) const noexcept {
    if ((a.meets && a.scale == 0) || (b.meets && b.scale == 0)) return false;
    if (!a.meets || !b.meets) return a.meets != b.meets;
    return std::abs(a.z - b.z) * std::max(a.scale, b.scale) > 0.5F * options_.tolerance &&
           !is_missing(u, v);
  }

  /// Whether a measurement lies at or behind the nearer surface, so that it tells of both.
  bool is_measured(const Rendered& a, const Rendered& b, int u, int v) const noexcept {
    const Rendered& nearer = !b.meets || (a.meets && a.z < b.z) ? a : b;
    const auto [r, pixel] =
        measure_along(image_, {u, v, nearer.z, nearer.scale}, options_.tolerance);
    return pixel >= 0 && r >= -options_.tolerance;
  }

  /// Count a ray for the shares of missing measurements.
  void count(const Rendered& a, const Rendered& b, int u, int v) noexcept {
    if (a.meets != b.meets) return;
    const bool missing = is_missing(u, v);
    if (!a.meets) return off_.add(missing);
    if (a.scale == 0 || b.scale == 0) return;
    on_.add(missing);
    alike_[slot_of(a)].add(missing);
    alike_[slot_of(b)].add(missing);
  }

  /// Log-likelihood of the measurement, relative to a pixel off the model.
  double log_likelihood(const Rendered& pose, int u, int v) const noexcept {
    if (!pose.meets) return 0;
    const float tolerance = options_.tolerance;
    const auto [r, pixel] = measure_along(image_, {u, v, pose.z, pose.scale}, tolerance);
    if (pixel < 0) return log_missing(pose);
    const std::uint8_t plane = image_.plane[static_cast<std::size_t>(pixel)];
    if (options_.is_background(plane)) {
      const bool contradicts = r > tolerance || (r < -tolerance && options_.is_solid(plane));
      return contradicts ? std::log(kBehindSurface) : 0;
    }
    const double share = static_cast<double>(r) / sigma_;
    const double agreement = (1 - blended_) * std::exp(-0.5 * share * share) +
                             blended_ / kBlend * std::exp(-0.5 * share * share / (kBlend * kBlend));
    const double mixture = kBehindSurface + (kAgreement - kBehindSurface) * agreement;
    return r < 0 && mixture < 1 ? 0 : std::log(mixture);
  }

 private:
  /// Share of rays without measurement.
  struct Share {
    double num = 0, num_missing = 0;

    void add(bool missing) noexcept {
      num += 1;
      num_missing += missing ? 1 : 0;
    }
    double missing() const noexcept { return std::max(kFewHoles, num_missing / num); }
  };

  /// Log-likelihood of a missing measurement, which is more frequent on a dark object, where its
  /// surface is seen aslant, and in the shadow beside it.
  double log_missing(const Rendered& pose) const noexcept {
    if (std::min(on_.num, off_.num) < kFewestRays) return 0;
    const Share& alike = alike_[slot_of(pose)];
    return std::log((alike.num < kFewestRays ? on_ : alike).missing() / off_.missing());
  }

  static std::size_t slot_of(const Rendered& pose) noexcept {
    return std::min(kSlots - 1, static_cast<std::size_t>(pose.facing * static_cast<float>(kSlots)));
  }

  const RangeImage& image_;
  const VerifyOptions& options_;
  double sigma_, blended_;
  static constexpr std::size_t kSlots = 5;  // of the cosine
  Share on_, off_;                          // rays that hit the model in both poses, and in neither
  std::array<Share, kSlots> alike_;         // those of the first that see it by a cosine
};

auto ball_of(const ImageGeometry& g, const ModelSamples& samples, const Pose& T_camera_model) {
  return project_ball(g, T_camera_model * samples.center, 0.5F * ball_diameter(samples));
}

}  // namespace

PoseComparison compare_poses(std::span<const RangeImage> images, const PosedModel& first,
                             const PosedModel& second, const MeasurementErrors& errors,
                             const VerifyOptions& options, CompareScratch& scratch) {
  const float diameter = std::max(first.samples.diameter, second.samples.diameter);
  const float sigma = std::hypot(errors.deviation, kFitError * diameter);
  PoseComparison out;
  double squares = 0;
  for (const RangeImage& image : images) {
    const ImageGeometry& g = image.geometry;
    const Pose T_camera_first = g.T_camera_scene * first.T_scene_model;
    const Pose T_camera_second = g.T_camera_scene * second.T_scene_model;
    const auto box = ball_of(g, first.samples, T_camera_first);
    const auto other = ball_of(g, second.samples, T_camera_second);
    if (!box && !other) continue;
    const RayCrop crop(box && other ? box->joined(*other) : box ? *box : *other, 0);
    shoot_rays(g, crop, first.surface, T_camera_first, scratch.directions, scratch.first);
    shoot_rays(g, crop, second.surface, T_camera_second, scratch.directions, scratch.second);

    Comparer comparer(image, sigma, errors.correlation, options);
    const int side =
        std::max(1, (errors.together + crop.stride / 2) / crop.stride);  // size of a block [rays]
    const double share = 1.0 / (side * side);
    const int columns = (crop.width + side - 1) / side, rows = (crop.height + side - 1) / side;
    scratch.votes.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    const auto for_each_ray = [&](auto&& visit) {
      for (int j = 0; j < crop.height; ++j) {
        for (int i = 0; i < crop.width; ++i) {
          const int u = crop.u(i), v = crop.v(j);
          if (u < 0 || v < 0 || u >= static_cast<int>(g.width) || v >= static_cast<int>(g.height))
            continue;
          const Eigen::Vector3f ray = ray_through(g, u, v);
          const std::size_t at = crop.at(i, j);
          visit(render(scratch.first, at, T_camera_first.linear(), ray),
                render(scratch.second, at, T_camera_second.linear(), ray), u, v,
                static_cast<std::size_t>(j / side) * static_cast<std::size_t>(columns) +
                    static_cast<std::size_t>(i / side));
        }
      }
    };
    for_each_ray([&](const Rendered& a, const Rendered& b, int u, int v, std::size_t) {
      comparer.count(a, b, u, v);
    });
    for_each_ray([&](const Rendered& a, const Rendered& b, int u, int v, std::size_t block) {
      if (!comparer.differ(a, b, u, v)) return;
      out.num_votes += share;
      const double vote =
          share * (comparer.log_likelihood(a, u, v) - comparer.log_likelihood(b, u, v));
      scratch.votes[block] += vote;
      if (comparer.is_measured(a, b, u, v)) {
        ++out.num_measured;
      } else if (comparer.is_missing(u, v)) {
        out.of_missing += vote;
      }
    });
    for (const double vote : scratch.votes) {
      out.log_ratio += vote;
      squares += vote * vote;
    }
  }
  if (squares > 0) out.z = out.log_ratio / std::sqrt(squares);
  return out;
}

}  // namespace trivet::kernels
