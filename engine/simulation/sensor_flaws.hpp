/// Deviations of a depth camera from the ideal one: the error laws of measure_scene and their
/// strengths.
///
/// The laws are from the literature. Their strengths differ between devices, settings and scenes,
/// so they are drawn for each scene from ranges that include the measurements of real cameras and
/// more (domain randomization: Tobin et al., IROS 2017).
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "kernels/common/counter_random.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"

namespace trivet {
enum class Sensor;
}

namespace trivet::engine {

/// Flaws of cameras that match windows of a pattern: structured light and stereo.
struct MatchFlaws {
  /// Half the side of a window; 0: every pixel is measured separately, without a match, and nothing
  /// else here applies. 1..kernels::kMaxHalfWindow.
  std::uint32_t half_window_pixel = 0;
  double dot_share = 0.1;         ///< share of pixels with a dot of the pattern, 0..1
  double taper = 0.1;             ///< reduction of the weight of a dot at a window's corner, 0..1
  double reach_pixel = 1;         ///< maximum disparity difference of agreeing dots
  std::uint32_t fewest_dots = 2;  ///< minimum number of agreeing dots
  double least_share = 0;         ///< minimum share of a window's dots that agree, 0..1

  /// Standard deviation of a full window's disparity. For a single dot it is larger by the square
  /// root of their number. In depth: z^2 s / (f b). Source: Khoshelham, Elberink, Sensors 12(2),
  /// 2012, for structured light; Keselman et al., CVPRW 2017, for stereo.
  double noise_pixel = 0;
  /// Share of the noise's variance that is independent for each pixel, 0..1.
  double white_share = 0;
  double frame_share = 0;  ///< share of the remaining noise that changes between frames, 0..1
  /// Number of frames averaged by a temporal filter; the pattern's error remains.
  std::uint32_t frames = 1;
  double wave_pixel = 0;  ///< root mean square of smooth bumps added to the noise
  double wave_length_pixel = 16;
  /// Amplitude of an error that is periodic with every whole disparity. Source: Grunnet-Jepsen et
  /// al., "Subpixel linearity improvement for Intel RealSense depth camera D400 series", 2019.
  double ripple_pixel = 0;
  double step_pixel = 0;  ///< disparity step of the quantization; 0: none

  std::uint32_t median_pixel = 0;     ///< radius of a median filter; 0: none
  std::uint32_t smoothing_pixel = 0;  ///< radius of a mean filter along rows, then columns; 0: none
  double smoothing_reach_pixel = 1;   ///< maximum disparity step that the mean filter crosses
  std::uint32_t fill_pixel = 0;       ///< maximum distance for filling holes; 0: no filling
  /// Whether holes are filled with the nearest depth around; otherwise with the farthest.
  bool fills_near = false;

  /// Factor of lower resolution at which depth is measured, then enlarged (decimation).
  std::uint32_t block_pixel = 1;
  /// Growth of the foreground on all sides over surfaces that lie more than `grow_jump_pixel` of
  /// disparity behind it, when the image is registered to another camera; 0: none.
  std::uint32_t grow_pixel = 0;
  double grow_jump_pixel = 1.5;

  bool light_on_left = false;  ///< side of the projector or second camera; false: right
  double baseline_m = 0;       ///< distance from the camera to it; 0: the sensor's own
  /// Minimum light of a visible dot: reflectance cos(angle) / z^2, 1 for white at 1 m, times
  /// speckle of `speckle`. Source: the dot light of Landau, Choo, Beling, "Simulating Kinect
  /// infrared and depth images", IEEE Trans. Cybernetics 46(12), 2016.
  double least_light = 0;
  double speckle = 0;           ///< standard deviation of the light's logarithm
  double steepest_degree = 80;  ///< steeper surfaces show no dots
  bool operator==(const MatchFlaws&) const = default;
};

/// Flaws of time-of-flight cameras. Without flaws each pixel's error is independent, and light
/// returns only from the surface that it sees.
struct EchoFlaws {
  double noise = 1;  ///< factor on the standard deviation of the noise law
  double wave = 0;   ///< root mean square of waves, relative to that deviation
  double wave_length_pixel = 16;
  std::uint32_t frames = 1;  ///< number of averaged frames; waves remain
  /// Factor on light that was reflected by another surface, which makes concave corners appear too
  /// far: one bounce between diffuse surfaces. Source: Jimenez, Pizarro, Mazo, Palazuelos,
  /// "Modeling and correction of multipath interference in time of flight cameras", Image and
  /// Vision Computing 32(1), 2014.
  double multipath = 0;
  double blur_pixel = 0;  ///< standard deviation of the light's blur by lens and pixels
  /// Error that is periodic in range, from harmonics of the modulation: Lindner, Kolb, "Lateral and
  /// depth calibration of PMD-distance sensors", ISVC 2006.
  double wiggle_m = 0, wiggle_period_m = 1;
  bool drops_edges = false;  ///< whether pixels at an edge are not measured, instead of floating
  std::uint32_t smoothing_pixel = 0;  ///< radius of a mean filter along rows, then columns; 0: none
  double smoothing_reach_m = 0.02;    ///< maximum range step that the mean filter crosses
  bool operator==(const EchoFlaws&) const = default;
};

/// Flaws of scanners with a laser line.
struct LineFlaws {
  double noise = 1;  ///< factor on the standard deviation of the noise law
  double wave = 0;   ///< root mean square of waves, relative to that deviation
  double wave_length_pixel = 16;
  /// Width of the line on the surface. At an edge, the center of the visible half is displaced to
  /// the side of the surface, and depth is wrong by up to half the width times z / b: Curless,
  /// Levoy, "Better optical triangulation through spacetime analysis", ICCV 1995. 0: edges are not
  /// measured.
  double beam_m = 0;
  bool operator==(const LineFlaws&) const = default;
};

/// Errors of the written values for a badly calibrated camera: 4 to 6 % of focal length in public
/// data sets, and absolute errors of a few cm between devices (Boehm, PFG 2014).
struct CalibrationFlaws {
  double focal = 0;   ///< relative error of both written focal lengths
  double aspect = 0;  ///< relative difference between them: half of it more for fx, less for fy
  double center_u_pixel = 0;  ///< displacement of the written principal point to the right
  double center_v_pixel = 0;  ///< displacement of the written principal point downward
  double depth = 0;           ///< relative error of written depths
  /// Displacement of the depth image to the right and downward, from an error in registering it to
  /// the color image.
  std::int32_t shift_u_pixel = 0, shift_v_pixel = 0;
  bool operator==(const CalibrationFlaws&) const = default;
};

struct SensorFlaws {
  MatchFlaws match{};
  EchoFlaws echo{};
  LineFlaws line{};
  CalibrationFlaws calibration{};
  /// Standard deviation of the logarithm of the reflected light, varying over `patch_length_pixel`,
  /// for patches of surfaces that reflect less light, such as print.
  double patches = 0;
  double patch_length_pixel = 40;
  std::uint32_t holes = 0;       ///< number of ellipses without measurement
  double hole_radius_pixel = 4;  ///< average radius of the ellipses
  bool operator==(const SensorFlaws&) const = default;
};

/// Draw the strength of each law for one scene; each may also be absent. Sensors have the flaws of
/// their kind, and all have those of calibration, patches and holes.
SensorFlaws draw_flaws(Sensor sensor, kernels::CounterRandom& random);

/// The written camera for a true one.
Camera written_camera(const Camera& camera, const CalibrationFlaws& flaws);

/// The distortion of space about the center of a badly calibrated camera. This linear map moves
/// each point to the place that its written pixel and depth indicate.
Eigen::Matrix3d written_from_true(const Camera& camera, const CalibrationFlaws& flaws);

/// The pose that fits the written image of an object best, given its true pose. The object's center
/// moves to where its pixel and depth indicate; the rotation is the one nearest to the map, which
/// also stretches.
///
/// center  center of the object, in the object's frame
Pose written_pose(const Pose& T_camera_model, const Eigen::Vector3d& center, const Camera& camera,
                  const CalibrationFlaws& flaws);

}  // namespace trivet::engine
