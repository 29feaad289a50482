/// How a scan errs, measured on the scan itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scans/correlated_noise.hpp"
#include "kernels/scans/range_image.hpp"

namespace trivet::kernels {

/// What a scan tells of the sensor that made it. Sensors that match windows of pixels, as
/// structured light of dots and stereo do, err alike in neighboring pixels, by more the farther
/// they look, and move the outlines of what they see by up to half a window. Sensors that measure
/// each pixel for itself do neither.
struct SensorModel {
  float range = 1;  ///< of which noise and correlated noise are told [scene unit], > 0
  /// Standard deviation across surfaces of what is independent from pixel to pixel, nearly
  /// [scene unit].
  float noise = 0;
  CorrelatedNoise correlated_noise{};  ///< of what neighbors share
  float exponent = 0;                  ///< of range: both heights grow with it to this power, 0..2
  float correlation = 0;  ///< 0..1: 0, pixels err for themselves; 1, neighbors err alike

  /// The same at a range [scene unit] > 0.
  float noise_at(float at_range) const noexcept { return noise * growth(at_range); }
  CorrelatedNoise correlated_noise_at(float at_range) const noexcept {
    return {correlated_noise.height * growth(at_range), correlated_noise.slope_rad};
  }
  /// Both together.
  float error_at(float at_range) const noexcept;
  /// Pixels by which an outline may be seen beside its place.
  float edge_pixels() const noexcept { return kEdgePixels * correlation; }

  /// Half a window of a matching sensor, of 9 to 11 pixels.
  static constexpr float kEdgePixels = 5;

 private:
  float growth(float at_range) const noexcept;
};

/// A square of pixels and what is left of its depth after a smooth surface is taken off.
struct SmoothPatch {
  float range = 0;        ///< mean depth
  float deviation = 0;    ///< standard deviation of the rest [scene unit]
  float correlation = 0;  ///< of the rests of neighbors in a row or a column, -1..1
};
inline constexpr std::size_t kPatchSide = 11;  ///< [pixel]

/// The patches whose upper rows are [first_row, first_row + num_rows) and a multiple of their
/// side, if all of their pixels are measured, none beyond a step of depth. Appends to `out`.
///
/// A quadratic in the image is taken off 1 / depth, in which a plane is linear. Of independent
/// noise, it leaves a correlation of -0.05.
/// Any split into rows gives the same patches in the same order.
void measure_patches(const RangeImage& image, std::size_t first_row, std::size_t num_rows,
                     std::vector<SmoothPatch>& out);

/// Tell exponent, correlation and, where no plane told it, correlated noise from patches; noise and
/// correlated noise are those at the median range of the measured pixels.
///
/// Scans at one range keep the prior of an active-light camera, an exponent of 1.5; with fewer than
/// eight patches errors are taken for independent, and the same at all ranges. Shape looks like
/// correlated error, so the smoothest third of the patches counts.
/// Source of the laws: depth from triangulation errs with the square of range (Khoshelham and
/// Elberink, Sensors 12(2), 2012), time of flight with less.
void fit_sensor_model(std::span<const SmoothPatch> patches, SensorModel& model);

}  // namespace trivet::kernels
