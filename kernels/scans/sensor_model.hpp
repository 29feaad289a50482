/// Error model of a scan's sensor, estimated from the scan itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kernels/scans/correlated_noise.hpp"
#include "kernels/scans/depth_steps.hpp"
#include "kernels/scans/range_image.hpp"

namespace trivet::kernels {

/// Errors of the sensor, estimated from its scan. Sensors that match windows of pixels, as
/// structured light with dots and stereo do, have correlated errors in neighboring pixels, which
/// grow with range, and shift the outlines of objects by up to half a window. Sensors that measure
/// each pixel separately do neither.
struct SensorModel {
  float range = 1;  ///< reference range of both noises [scene unit], > 0
  /// Standard deviation across surfaces of the nearly independent noise of pixels [scene unit].
  float noise = 0;
  CorrelatedNoise correlated_noise{};  ///< noise shared by neighboring pixels
  float exponent = 0;     ///< exponent of range: both noises grow with this power of it, 0..2
  float correlation = 0;  ///< 0..1: 0, errors are independent; 1, neighbors err alike
  bool may_be_smoothed = false;  ///< whether the scan has no abrupt steps, as filters leave it
  /// Length over which a filter has smoothed the depth along rows and columns [pixel]; 0: none has.
  float smoothing = 0;

  /// The noise at a range [scene unit] > 0.
  float noise_at(float at_range) const noexcept { return noise * growth(at_range); }
  CorrelatedNoise correlated_noise_at(float at_range) const noexcept {
    return {correlated_noise.height * growth(at_range), correlated_noise.slope_rad};
  }
  /// Independent and correlated noise together.
  float error_at(float at_range) const noexcept;
  /// The range from which on both noises are larger than so many times those at the reference range
  /// [scene unit]; infinite or 0 if they are the same at all ranges.
  float range_of_growth(float factor) const noexcept;
  /// The same sensor with a filter of this length, which makes neighbors err alike; 0: without one.
  SensorModel smoothed_by(float length) const noexcept;
  /// Largest shift of an outline in the image [pixel].
  float edge_pixels() const noexcept { return kEdgePixels * correlation; }

  /// Half the window of a matching sensor, of 9 to 11 pixels.
  static constexpr float kEdgePixels = 5;

 private:
  float growth(float at_range) const noexcept;
};

/// A square of pixels and its depth residuals from a smooth surface.
struct SmoothPatch {
  float range = 0;        ///< mean depth
  float deviation = 0;    ///< standard deviation of the residuals [scene unit]
  float correlation = 0;  ///< correlation of residuals of neighbors in a row or a column, -1..1
};
inline constexpr std::size_t kPatchSide = 11;  ///< [pixel]

/// Appends to `out` the patches whose upper rows are in [first_row, first_row + num_rows) and a
/// multiple of their side. All pixels of a patch are measured, without a depth step between them.
///
/// A quadratic in the image is subtracted from 1 / depth, in which a plane is linear. For
/// independent noise, the residuals then have a correlation of -0.05.
/// Any split into rows gives the same patches in the same order.
void measure_patches(const RangeImage& image, std::size_t first_row, std::size_t num_rows,
                     std::vector<SmoothPatch>& out);

/// Estimate exponent, correlation and, if no plane determined it, correlated noise from patches.
/// Noise and correlated noise are those at the median range of the measured pixels.
///
/// Scans at one range keep the prior of an active-light camera, an exponent of 1.5. With fewer than
/// eight patches, errors are assumed to be independent and the same at all ranges. Shape looks like
/// correlated error, so only the smoothest third of the patches counts.
/// Source of the laws: depth errors from triangulation grow with the square of range (Khoshelham
/// and Elberink, Sensors 12(2), 2012), those of time of flight grow less.
void fit_sensor_model(std::span<const SmoothPatch> patches, SensorModel& model);

/// Whether a filter may have smoothed a scan: hardly any of its steps is abrupt.
bool may_be_smoothed(const StepCounts& counts) noexcept;

/// Lengths of filters to try [pixel], the first without effect.
inline constexpr std::array<float, 4> kSmoothingLengths{0, 1.5F, 3, 5};

/// The length that the probabilities of poses speak for, if they do so clearly: by the mean log odds
/// of the poses that are likely at some length. Empty if none is.
///
/// probabilities  of each pose at each of kSmoothingLengths
std::optional<float> choose_smoothing(
    std::span<const std::array<float, kSmoothingLengths.size()>> probabilities) noexcept;

}  // namespace trivet::kernels
