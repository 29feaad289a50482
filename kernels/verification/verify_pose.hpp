/// Comparison of a posed model with the scan.
#pragma once

#include <bitset>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scans/range_image.hpp"
#include "kernels/surfaces/model_samples.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Whether a pixel's plane number (0: none) belongs to a background plane.
///
/// plane_is_background  one per plane number from 1 on
inline bool is_background_plane(std::span<const std::uint8_t> plane_is_background,
                                std::uint8_t plane) noexcept {
  return plane > 0 && plane <= plane_is_background.size() && plane_is_background[plane - 1] != 0;
}

/// Planes of a scan, by number.
using PlaneSet = std::bitset<256>;

struct VerifyOptions {
  float tolerance = 0;  ///< largest perpendicular distance of agreement [scene unit], > 0
  float max_normal_angle_rad = 0.8F;  ///< largest angle between model and scene normals
  /// One per plane number: 1 if the plane is too large to be part of this model.
  std::span<const std::uint8_t> plane_is_background;
  /// Number of the plane that the model bears on, so that a part of it may be let into a hole
  /// there; 0: none.
  std::uint8_t bearing_plane = 0;
  /// Planes that hide what is behind them as any surface does: faces of bodies that end nearby.
  PlaneSet open_planes{};

  /// Whether a pixel's plane number (0: none) belongs to a background plane.
  bool is_background(std::uint8_t plane) const noexcept {
    return is_background_plane(plane_is_background, plane);
  }
  /// Whether it belongs to a plane that the model cannot reach behind.
  bool is_solid(std::uint8_t plane) const noexcept {
    return is_background(plane) && plane != bearing_plane && !open_planes[plane];
  }
};

/// Scene beyond the outline of a posed model.
struct ContourEvidence {
  std::uint32_t free = 0;     ///< places where the scene falls back or is not measured
  std::uint32_t crossed = 0;  ///< places where the scene continues at the model's depth
};

/// Counts for the samples that should be visible, over all images.
struct Evidence {
  /// Samples that face a camera inside the image, not hidden by the model itself.
  std::uint32_t visible = 0;
  std::uint32_t consistent = 0;  ///< measured depth and normal agree with the model
  std::uint32_t oblique = 0;     ///< depth agrees, normal does not
  /// The sensor saw through the model, or the model cuts into a background plane.
  std::uint32_t violation = 0;
  std::uint32_t occluded = 0;    ///< something nearer hides the sample
  std::uint32_t unknown = 0;     ///< no measurement
  std::uint32_t outside = 0;     ///< outside the image (not counted in visible)
  std::uint32_t background = 0;  ///< agrees only with a background plane
  float weight = 0;  ///< sum over consistent samples of (1 - (r / tolerance)^2) cos(normals)
  float squared_residuals = 0;  ///< sum over consistent samples [scene unit^2]
  /// Contour places beyond which the scene falls back or is not measured.
  std::uint32_t contour_free = 0;
  /// Contour places beyond which the scene continues at the model's depth.
  std::uint32_t contour_crossed = 0;

  void add(const ContourEvidence& contour) noexcept {
    contour_free += contour.free;
    contour_crossed += contour.crossed;
  }

  float support() const noexcept;  ///< mean agreement of the visible samples, 0..1
  /// Share of the samples that should be visible and agree.
  float visible_fraction() const noexcept;
  float violation_fraction() const noexcept;
  /// Free share of the judged contour; 1 with too few places to judge.
  float contour() const noexcept;
  float rmse() const noexcept;  ///< RMS residual of consistent samples [scene unit]
  /// (support x (1 - violation) x contour)^1.5 x visible^0.2, 0..1. Agreement weighs more than
  /// visibility: right poses of occluded objects agree as well as others (support above 0.74 on the
  /// development scans), while wrong ones on clutter are mostly visible and agree little. There,
  /// the exponents put the two kinds on opposite sides of 0.5.
  float score() const noexcept;
};

/// Compare the first `num_samples` samples with the images along the viewing rays.
///
/// A sample is visible if its view mask has the bit of the direction to the camera and its normal
/// is within 81 degrees of the ray. With measured depth d, model depth z and the angle between ray
/// and normal, r = (d - z) cos: |r| <= tolerance is agreement, r > tolerance a violation, r <
/// -tolerance occlusion. If the pixel itself does not agree, the best of it and its 4 neighbors
/// counts.
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

/// Judge the contour. The posed model's outline is drawn by its first `num_samples` samples on a
/// grid of their spacing. Just beyond it, the scene of a real object falls back or is not measured
/// (sensors fail at depth edges), while for a wrong fit on a larger surface that surface continues.
/// Something nearer is neutral, and so are background planes: objects stand on them.
ContourEvidence judge_contour(std::span<const RangeImage> images, const ModelSamples& samples,
                              std::size_t num_samples, const Pose& T_scene_model,
                              const VerifyOptions& options, ContourScratch& scratch);

}  // namespace trivet::kernels
