/// How a depth camera falls short of the ideal one: every law that measure_scene knows, and how
/// strong each is.
///
/// The laws are of the literature; how strong each is differs from one unit, setting and scene to
/// the next, so that it is drawn anew for each scene, over ranges that hold what has been measured
/// of real ones and more (domain randomization: Tobin et al., IROS 2017).
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

/// Of cameras that match windows of a pattern: structured light and stereo.
struct MatchFlaws {
  /// Half the side of a window; 0: every pixel is measured by itself, without a match, and nothing
  /// else here counts. 1..kernels::kMaxHalfWindow.
  std::uint32_t half_window_pixel = 0;
  double dot_share = 0.1;         ///< of pixels that show a dot of the pattern, 0..1
  double taper = 0.1;             ///< what a dot at a window's corner weighs less, 0..1
  double reach_pixel = 1;         ///< dots agree within so much disparity
  std::uint32_t fewest_dots = 2;  ///< that have to agree
  double least_share = 0;         ///< of a window's dots that have to agree, 0..1

  /// Standard deviation of a full window's disparity; of a single dot it is greater by the root of
  /// their number. In depth: z^2 s / (f b). Source: Khoshelham, Elberink, Sensors 12(2), 2012, for
  /// structured light; Keselman et al., CVPRW 2017, for stereo.
  double noise_pixel = 0;
  double white_share = 0;    ///< of the noise's variance that each pixel has for itself, 0..1
  double frame_share = 0;    ///< of the rest that changes from frame to frame, 0..1
  std::uint32_t frames = 1;  ///< averaged by a temporal filter; the pattern's own error stays
  double wave_pixel = 0;     ///< root mean square of bumps beside the noise
  double wave_length_pixel = 16;
  /// Height of an error that repeats with every whole disparity. Source: Grunnet-Jepsen et al.,
  /// "Subpixel linearity improvement for Intel RealSense depth camera D400 series", 2019.
  double ripple_pixel = 0;
  double step_pixel = 0;  ///< disparity is told in such steps; 0: not

  std::uint32_t median_pixel = 0;     ///< radius of a median filter; 0: none
  std::uint32_t smoothing_pixel = 0;  ///< radius of a mean along rows, then columns; 0: none
  double smoothing_reach_pixel = 1;   ///< of disparity that the mean reaches across
  std::uint32_t fill_pixel = 0;       ///< holes are filled from so far around; 0: not
  bool fills_near = false;            ///< ... with the nearest depth around, else with the farthest

  std::uint32_t block_pixel = 1;  ///< depth is measured so coarsely, and enlarged (decimation)
  /// The foreground grows so much over what lies more than `grow_jump_pixel` of disparity behind,
  /// on all sides, when the image is registered to another camera; 0: not.
  std::uint32_t grow_pixel = 0;
  double grow_jump_pixel = 1.5;

  bool light_on_left = false;  ///< the projector or second camera; else on the right
  double baseline_m = 0;       ///< from the camera to it; 0: the sensor's own
  /// A dot is seen where reflectance cos(angle) / z^2, 1 for white at 1 m, times speckle of
  /// `speckle`, is more. Source: the dot light of Landau, Choo, Beling, "Simulating Kinect infrared
  /// and depth images", IEEE Trans. Cybernetics 46(12), 2016.
  double least_light = 0;
  double speckle = 0;           ///< standard deviation of the light's logarithm
  double steepest_degree = 80;  ///< surfaces beyond show no dots
  bool operator==(const MatchFlaws&) const = default;
};

/// Of time-of-flight cameras. With none of them each pixel errs by itself, and light comes back
/// from what it sees only.
struct EchoFlaws {
  double noise = 1;  ///< multiplies the law's standard deviation
  double wave = 0;   ///< root mean square of waves, in that deviation
  double wave_length_pixel = 16;
  std::uint32_t frames = 1;  ///< averaged; waves stay
  /// Multiplies light that came over another surface, which makes concave corners read too far: one
  /// bounce between diffuse surfaces. Source: Jimenez, Pizarro, Mazo, Palazuelos, "Modeling and
  /// correction of multipath interference in time of flight cameras", Image and Vision Computing
  /// 32(1), 2014.
  double multipath = 0;
  double blur_pixel = 0;  ///< standard deviation of the lens' and the pixels' blur of light
  /// Error that repeats with range, of the modulation's harmonics: Lindner, Kolb, "Lateral and
  /// depth calibration of PMD-distance sensors", ISVC 2006.
  double wiggle_m = 0, wiggle_period_m = 1;
  bool drops_edges = false;  ///< pixels that see an edge are not measured, instead of floating
  std::uint32_t smoothing_pixel = 0;  ///< radius of a mean along rows, then columns; 0: none
  double smoothing_reach_m = 0.02;    ///< of range that the mean reaches across
  bool operator==(const EchoFlaws&) const = default;
};

/// Of scanners with a line of laser light.
struct LineFlaws {
  double noise = 1;  ///< multiplies the law's standard deviation
  double wave = 0;   ///< root mean square of waves, in that deviation
  double wave_length_pixel = 16;
  /// Width of the line on the surface. Half on an edge, its middle is seen too far to the side of
  /// the surface, and depth is wrong by up to a half of it, times z / b: Curless, Levoy, "Better
  /// optical triangulation through spacetime analysis", ICCV 1995. 0: edges are not measured.
  double beam_m = 0;
  bool operator==(const LineFlaws&) const = default;
};

/// What is written for what is measured, by a camera that is not calibrated well: 4 to 6 % of
/// focal length in public data sets, and absolute errors of a few cm between units (Boehm, PFG
/// 2014).
struct CalibrationFlaws {
  double focal = 0;           ///< focal lengths written are longer by this share, both
  double aspect = 0;          ///< fx by half of this share more, fy less
  double center_u_pixel = 0;  ///< the principal point written lies so much to the right
  double center_v_pixel = 0;  ///< ... and down
  double depth = 0;           ///< depths written are longer by this share
  /// The depth image lies so much to the right of and below where the camera sees it: registered
  /// to the color image with an error.
  std::int32_t shift_u_pixel = 0, shift_v_pixel = 0;
  bool operator==(const CalibrationFlaws&) const = default;
};

struct SensorFlaws {
  MatchFlaws match{};
  EchoFlaws echo{};
  LineFlaws line{};
  CalibrationFlaws calibration{};
  /// Patches of surfaces that throw less light back, as print does: the logarithm of the light
  /// varies by so much over `patch_length_pixel`.
  double patches = 0;
  double patch_length_pixel = 40;
  std::uint32_t holes = 0;       ///< ellipses without measurement
  double hole_radius_pixel = 4;  ///< of them, on average
  bool operator==(const SensorFlaws&) const = default;
};

/// Draw how strong each law is for one scene; each is also absent at times. Sensors have the flaws
/// of their kind, and all of them those of calibration, patches and holes.
SensorFlaws draw_flaws(Sensor sensor, kernels::CounterRandom& random);

/// The camera that is written for a true one.
Camera written_camera(const Camera& camera, const CalibrationFlaws& flaws);

/// What a badly calibrated camera makes of space about its center: a linear map that takes each
/// point to where its pixel and depth, as they are written, say that it is.
Eigen::Matrix3d written_from_true(const Camera& camera, const CalibrationFlaws& flaws);

/// The pose that fits what is written of an object best, for its true pose: the object's center
/// goes where its pixel and depth say; the rotation is the one nearest to the map, which also
/// stretches.
///
/// center  of the object, in its own frame
Pose written_pose(const Pose& T_camera_model, const Eigen::Vector3d& center, const Camera& camera,
                  const CalibrationFlaws& flaws);

}  // namespace trivet::engine
