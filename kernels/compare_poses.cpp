#include "kernels/compare_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace trivet::kernels {
namespace {

constexpr float kGrazing = 0.17F;      // cosine below which a surface is too oblique to be measured
constexpr float kFitError = 0.004F;    // of model and pose, as a share of the diameter
constexpr double kAgreement = 10;      // likelihood of r = 0 over that of a pixel off the model
constexpr double kSeenThrough = 0.03;  // ... of a measurement anywhere behind the surface

/// One pose's rendering of one ray.
struct Rendered {
  bool meets = false;
  float z = 0;
  float scale = 0;  // perpendicular distance per depth; 0 where the surface is grazing
};

Rendered render(const CompareScratch::Look& look, std::size_t at, const Eigen::Matrix3f& R,
                const Eigen::Vector3f& ray) noexcept {
  const float z = look.depth[at];
  if (!std::isfinite(z)) return {};
  const float length = ray.norm();
  const float facing = std::abs((R * look.normals[at]).dot(ray)) / length;
  return {true, z, facing > kGrazing ? facing * length : 0};
}

class Comparer {
 public:
  Comparer(const RangeImage& image, float sigma, const VerifyOptions& options)
      : image_(image), options_(options), sigma_(static_cast<double>(sigma)) {}

  /// Whether the renderings tell the poses apart here.
  bool differ(const Rendered& a, const Rendered& b) const noexcept {
    if ((a.meets && a.scale == 0) || (b.meets && b.scale == 0)) return false;
    if (!a.meets || !b.meets) return a.meets != b.meets;
    return std::abs(a.z - b.z) * std::max(a.scale, b.scale) > 0.5F * options_.tolerance;
  }

  /// Log-likelihood of what was measured, relative to a pixel off the model.
  double log_likelihood(const Rendered& pose, int u, int v) const noexcept {
    if (!pose.meets) return 0;
    const float tolerance = options_.tolerance;
    const auto [r, pixel] = measure_along(image_, u, v, pose.z, pose.scale, tolerance);
    if (pixel < 0) return 0;
    if (options_.is_background(image_.plane[static_cast<std::size_t>(pixel)]))
      return std::abs(r) <= tolerance ? 0 : std::log(kSeenThrough);
    const double share = static_cast<double>(r) / sigma_;
    const double mixture =
        kSeenThrough + (kAgreement - kSeenThrough) * std::exp(-0.5 * share * share);
    return r < 0 && mixture < 1 ? 0 : std::log(mixture);
  }

 private:
  const RangeImage& image_;
  const VerifyOptions& options_;
  double sigma_;
};

}  // namespace

PoseComparison compare_poses(std::span<const RangeImage> images, const RayScene& surface,
                             const ModelSamples& samples, const Pose& T_scene_first,
                             const Pose& T_scene_second, const MeasurementErrors& errors,
                             const VerifyOptions& options, CompareScratch& scratch) {
  const float sigma = std::hypot(errors.deviation, kFitError * samples.diameter);
  const float radius = 0.5F * ball_diameter(samples);
  PoseComparison out;
  double squares = 0;
  for (const RangeImage& image : images) {
    const ImageGeometry& g = image.geometry;
    const Pose T_camera_first = g.T_camera_scene * T_scene_first;
    const Pose T_camera_second = g.T_camera_scene * T_scene_second;
    const auto box = project_ball(g, T_camera_first * samples.centre, radius);
    const auto other = project_ball(g, T_camera_second * samples.centre, radius);
    if (!box && !other) continue;
    const RayCrop crop(box && other ? box->joined(*other) : box ? *box : *other, 0);
    shoot_rays(g, crop, surface, T_camera_first, scratch.directions, scratch.first.depth,
               scratch.first.normals);
    shoot_rays(g, crop, surface, T_camera_second, scratch.directions, scratch.second.depth,
               scratch.second.normals);

    const Comparer comparer(image, sigma, options);
    const int side =
        std::max(1, (errors.together + crop.stride / 2) / crop.stride);  // of a block [rays]
    const double share = 1.0 / (side * side);
    const int columns = (crop.width + side - 1) / side, rows = (crop.height + side - 1) / side;
    scratch.votes.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    for (int j = 0; j < crop.height; ++j) {
      for (int i = 0; i < crop.width; ++i) {
        const int u = crop.u(i), v = crop.v(j);
        if (u < 0 || v < 0 || u >= static_cast<int>(g.width) || v >= static_cast<int>(g.height))
          continue;
        const Eigen::Vector3f ray = ray_through(g, u, v);
        const std::size_t at = crop.at(i, j);
        const Rendered a = render(scratch.first, at, T_camera_first.linear(), ray);
        const Rendered b = render(scratch.second, at, T_camera_second.linear(), ray);
        if (!comparer.differ(a, b)) continue;
        out.num_votes += share;
        scratch.votes[static_cast<std::size_t>(j / side * columns + i / side)] +=
            share * (comparer.log_likelihood(a, u, v) - comparer.log_likelihood(b, u, v));
      }
    }
    for (const double vote : scratch.votes) {
      out.log_ratio += vote;
      squares += vote * vote;
    }
  }
  if (squares > 0) out.z = out.log_ratio / std::sqrt(squares);
  return out;
}

}  // namespace trivet::kernels
