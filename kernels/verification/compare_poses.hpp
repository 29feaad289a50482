/// Decide between two posed models that look alike, by the pixels where they do not: poses of one
/// model, or models of one place.
#pragma once

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
  /// 0.6 % of a normal distribution lie beyond it on one side, and as few of the decisions between
  /// near-symmetric poses on rendered scans were wrong (docs/measurements.md, "Alternative poses").
  static constexpr double kSignificant = 2.5;

  double log_ratio = 0;  ///< of the likelihoods of the votes; above 0: the first pose is better
  double num_votes = 0;  ///< blocks of pixels in which the poses differ
  double z = 0;  ///< log_ratio in its standard deviations; at most sqrt(num_votes) in size, about

  bool significant() const noexcept { return z > kSignificant || z < -kSignificant; }
};

/// How measurements err across the surface.
struct MeasurementErrors {
  float deviation = 0;    ///< standard deviation [scene unit], >= 0
  int together = 3;       ///< side of a block of pixels that err alike [pixel], >= 1
  float correlation = 0;  ///< from pixel to pixel, 0..1
};

/// Working memory of compare_poses.
struct CompareScratch {
  Points directions;
  RayHits first, second;
  std::vector<double> votes;
};

/// Shoot rays at both through the pixels that either may cover, at most some 2,500 an image, and
/// add up log p(measured | first) - log p(measured | second) where the renderings differ: where
/// depths are half a tolerance apart, or only one of them is met.
///
/// Of a pose that meets the model: with r the perpendicular residual, the likelihood is that of a
/// normal distribution around 0, as wide as noise and error of model and pose together, mixed with
/// a uniform one (relative to what a pixel off the model may show). Measured in front is occlusion
/// and says nothing, unless it is a background plane, which nothing reaches through; nor does a
/// background plane at the model's depth or a grazing surface. Where neighbors err alike, part of
/// the normal distribution is eight times as wide: thin parts and edges are blended with what lies
/// beside them. Without a measurement the likelihood is the share of such rays among those that
/// both poses meet the model by, over the share among those that neither does. A block of pixels
/// that err alike has one vote.
/// compare_poses(b, a) is exactly the negative of compare_poses(a, b).
/// Source: Vuong, Econometrica 1989 (likelihood ratio of models that do not contain each other); z
/// takes the mean square of the votes for their variance, so that a few cannot be significant.
PoseComparison compare_poses(std::span<const RangeImage> images, const PosedModel& first,
                             const PosedModel& second, const MeasurementErrors& errors,
                             const VerifyOptions& options, CompareScratch& scratch);

}  // namespace trivet::kernels
