/// Decision between two similar posed models by the pixels where they differ: poses of one model,
/// or models at one place.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kernels/common/ray_scene.hpp"
#include "kernels/scans/range_image.hpp"
#include "kernels/verification/ray_crop.hpp"
#include "kernels/verification/verify_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// How much better a first pose explains the scan than a second one.
struct PoseComparison {
  /// Of a normal distribution, 0.6 % lie beyond it on one side, and as few of the decisions between
  /// near-symmetric poses on rendered scans were wrong (docs/verification.md, "Alternative poses").
  static constexpr double kSignificant = 2.5;

  double log_ratio = 0;   ///< log likelihood ratio of the votes; above 0: the first pose is better
  double of_missing = 0;  ///< part of log_ratio that pixels without measurement contribute
  double num_votes = 0;   ///< blocks of pixels in which the poses differ
  double z = 0;  ///< log_ratio in standard deviations; roughly at most sqrt(num_votes) in magnitude
  /// Rays in which the poses differ and something is measured, at or behind the nearer of them.
  std::size_t num_measured = 0;

  bool significant() const noexcept { return z > kSignificant || z < -kSignificant; }
};

/// Measurement errors across the surface.
struct MeasurementErrors {
  float deviation = 0;    ///< standard deviation [scene unit], >= 0
  int together = 3;       ///< side of a block of pixels with shared errors [pixel], >= 1
  float correlation = 0;  ///< correlation of errors from pixel to pixel, 0..1
};

/// Working memory of compare_poses.
struct CompareScratch {
  Points directions;
  RayHits first, second;
  std::vector<double> votes;
};

/// Cast rays at both through the pixels that either may cover, at most some 2,500 per image, and
/// add up log p(measured given first) - log p(measured given second) where the renderings differ:
/// where something is measured and depths are half a tolerance apart, or only one of them is hit.
///
/// If the ray hits the model, the likelihood of the perpendicular residual r is a normal
/// distribution around 0, as wide as noise and error of model and pose together, mixed with a
/// uniform one (relative to the distribution at a pixel off the model). A measurement in front is
/// occlusion and no evidence, unless it is a background plane, through which nothing can reach; nor
/// is a background plane at the model's depth or a grazing surface. If neighbors err alike, part of
/// the normal distribution is eight times as wide: thin parts and edges blend with their
/// surroundings. Without a measurement, the likelihood is the share of such rays among those that
/// hit the model in both poses where it faces them alike (sensors lose surfaces seen aslant), over
/// the share among those that hit it in neither. A block of pixels with shared errors has one vote.
/// compare_poses(b, a) is exactly the negative of compare_poses(a, b).
/// Source: Vuong, Econometrica 1989 (likelihood ratio of non-nested models); z uses the mean square
/// of the votes as their variance, so that a few cannot be significant.
PoseComparison compare_poses(std::span<const RangeImage> images, const PosedModel& first,
                             const PosedModel& second, const MeasurementErrors& errors,
                             const VerifyOptions& options, CompareScratch& scratch);

}  // namespace trivet::kernels
