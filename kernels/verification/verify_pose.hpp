/// Hold a posed model against what the sensor saw.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scans/range_image.hpp"
#include "kernels/surfaces/model_samples.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

struct VerifyOptions {
  float tolerance = 0;  ///< perpendicular distance still taken as agreement [scene unit], > 0
  float max_normal_angle_rad = 0.8F;  ///< between model and scene normals
  /// By plane number: too large to be part of this model.
  std::span<const std::uint8_t> plane_is_background;

  /// Whether a pixel's plane number, 0 for none, names such a plane.
  bool is_background(std::uint8_t plane) const noexcept {
    return plane > 0 && plane <= plane_is_background.size() && plane_is_background[plane - 1] != 0;
  }
};

/// What lies beyond places of a posed model's outline.
struct ContourEvidence {
  std::uint32_t free = 0;     ///< the scene falls back or is not measured
  std::uint32_t crossed = 0;  ///< the scene runs on at the model's depth
};

/// What the samples that should be visible met, over all images.
struct Evidence {
  /// Samples that face a camera, not hidden by the model, inside the image.
  std::uint32_t visible = 0;
  std::uint32_t consistent = 0;  ///< measured where the model says, normals agree
  std::uint32_t oblique = 0;     ///< measured where the model says, normals disagree
  /// The sensor looked through the model, or the model cuts into a background plane.
  std::uint32_t violation = 0;
  std::uint32_t occluded = 0;    ///< something nearer hides the sample
  std::uint32_t unknown = 0;     ///< no measurement
  std::uint32_t outside = 0;     ///< outside the image (not counted in visible)
  std::uint32_t background = 0;  ///< agrees only with a background plane
  float weight = 0;  ///< sum over consistent samples of (1 - (r / tolerance)^2) cos(normals)
  float squared_residuals = 0;  ///< over consistent samples [scene unit^2]
  /// Contour places beyond which the scene falls back or is not measured.
  std::uint32_t contour_free = 0;
  /// Contour places beyond which the scene runs on at the model's depth.
  std::uint32_t contour_crossed = 0;

  void add(const ContourEvidence& contour) noexcept {
    contour_free += contour.free;
    contour_crossed += contour.crossed;
  }

  float support() const noexcept;  ///< mean agreement of what was seen, 0..1
  /// Agreeing share of the samples that should be visible.
  float visible_fraction() const noexcept;
  float violation_fraction() const noexcept;
  /// Share of the judged contour that is free; 1 with too few to judge.
  float contour() const noexcept;
  float rmse() const noexcept;  ///< over consistent samples [scene unit]
  /// (support x (1 - violation) x contour)^1.5 x visible^0.2, 0..1. Agreement weighs more than
  /// visibility: right poses of occluded objects agree as well as others (support above 0.74 on the
  /// development scans), wrong ones on clutter see much and agree little. The exponents put both
  /// kinds on the two sides of 0.5 there.
  float score() const noexcept;
};

/// Compare the first `num_samples` samples with the images along the viewing rays.
///
/// A sample is visible when its view mask has the bit of the direction to the camera and its normal
/// is within 81 degrees of the ray. With measured depth d, model depth z and the angle between ray
/// and normal, r = (d - z) cos: |r| <= tolerance is agreement, r > tolerance a violation,
/// r < -tolerance occlusion; where the pixel itself does not agree, the best of it and its 4
/// neighbors counts.
///
/// explained  if given, the pixel (offset by the images before it) of every consistent sample is
///            appended
/// Source: Papazov and Burschka, ACCV 2010, acceptance by visibility and penalty; extended by
/// normals and planes.
Evidence verify_pose(std::span<const RangeImage> images, const ModelSamples& samples,
                     std::size_t num_samples, const Pose& T_scene_model,
                     const VerifyOptions& options, std::vector<std::uint32_t>* explained = nullptr);

/// Working memory of judge_contour.
struct ContourScratch {
  std::vector<float> depth;
};

/// Judge the contour: the posed model's outline is drawn by its first `num_samples`
/// samples on a grid as coarse as they are; just beyond it a real object's scene falls back or is
/// not measured (sensors fail at depth edges), while a wrong fit on a larger surface finds that
/// surface running on. Something nearer is neutral, and so are background planes: things stand on
/// them.
ContourEvidence judge_contour(std::span<const RangeImage> images, const ModelSamples& samples,
                              std::size_t num_samples, const Pose& T_scene_model,
                              const VerifyOptions& options, ContourScratch& scratch);

}  // namespace trivet::kernels
