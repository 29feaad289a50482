#include "engine/simulation/sensor_flaws.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "engine/simulation/measure_scene.hpp"

namespace trivet::engine {
namespace {

using kernels::CounterRandom;

constexpr double kMostOfADot = 0.45;  // [pixel of disparity]

bool happens(CounterRandom& random, double share) { return random.uniform() < share; }

/// A random number, uniform in its logarithm.
double between_logs(CounterRandom& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

std::uint32_t draw_integer(CounterRandom& random, std::uint32_t low, std::uint32_t high) {
  return low + static_cast<std::uint32_t>(random.next() % (high - low + 1));
}

/// A random error: absent in a fifth of the cases, mostly small, sometimes up to the largest.
double error(CounterRandom& random, double usual, double largest) {
  const double kind = random.uniform(), small = usual * random.normal(),
               wide = random.uniform(-largest, largest);
  if (kind < 0.2) return 0;
  return kind < 0.65 ? std::clamp(small, -largest, largest) : wide;
}

CalibrationFlaws draw_calibration(CounterRandom& random) {
  CalibrationFlaws flaws;
  flaws.focal = error(random, 0.01, 0.05);
  flaws.aspect = error(random, 0.0015, 0.01);
  flaws.center_u_pixel = error(random, 1.5, 8);
  flaws.center_v_pixel = error(random, 1.5, 8);
  flaws.depth = error(random, 0.002, 0.01);
  flaws.shift_u_pixel = static_cast<std::int32_t>(std::lround(error(random, 1, 3)));
  flaws.shift_v_pixel = static_cast<std::int32_t>(std::lround(error(random, 1, 3)));
  return flaws;
}

MatchFlaws draw_match(Sensor sensor, CounterRandom& random) {
  const bool stereo = sensor == Sensor::stereo;
  MatchFlaws flaws;
  flaws.half_window_pixel = draw_integer(random, stereo ? 2 : 3, 6);
  const double pixels = std::pow(2 * flaws.half_window_pixel + 1, 2);
  // Fewer than five dots per window would leave holes everywhere. For stereo, surfaces add texture
  // between the dots.
  flaws.dot_share = std::max(5 / pixels, random.uniform(0.06, stereo ? 0.18 : 0.12));
  flaws.taper = random.uniform(0.05, 0.9);
  flaws.reach_pixel = random.uniform(0.7, 1.3);
  flaws.fewest_dots = draw_integer(random, 2, 3);
  flaws.least_share = happens(random, 0.25) ? 0 : random.uniform(0.1, 0.65);

  // Dots with much larger errors would not agree with one another.
  flaws.noise_pixel =
      std::min(between_logs(random, 0.04, 0.15), kMostOfADot / std::sqrt(flaws.dot_share * pixels));
  flaws.white_share = random.uniform(0, 0.4);
  flaws.frame_share = random.uniform(0.2, 0.8);
  flaws.frames = happens(random, 0.6) ? 1 : draw_integer(random, 2, 10);
  const double wave = random.uniform();
  flaws.wave_pixel = flaws.noise_pixel * (wave < 0.2   ? 0
                                          : wave < 0.5 ? random.uniform(0.3, 1)
                                                       : random.uniform(1, stereo ? 4 : 3));
  flaws.wave_length_pixel = between_logs(random, 8, 80);
  flaws.ripple_pixel = happens(random, 0.5) ? 0 : random.uniform(0, 0.06);
  const double step = random.uniform();
  flaws.step_pixel = step < 0.15 ? 0 : step < 0.3 ? 1.0 / 16 : stereo ? 1.0 / 32 : 1.0 / 8;

  const double filter = random.uniform();
  flaws.median_pixel = filter < 0.2 ? draw_integer(random, 1, 2) : 0;
  flaws.smoothing_pixel = filter > 0.5 ? draw_integer(random, 1, 6) : 0;
  flaws.smoothing_reach_pixel = between_logs(random, 0.3, 6);
  flaws.fill_pixel =
      happens(random, 0.5) ? 0 : static_cast<std::uint32_t>(between_logs(random, 2, 20));
  flaws.fills_near = happens(random, 0.4);

  if (happens(random, 0.3)) {
    flaws.block_pixel = 2;
    flaws.smoothing_pixel *= 2;
  }
  const double grown = random.uniform();  // mostly none, rarely three
  flaws.grow_pixel = grown < 0.6 ? 0 : grown < 0.8 ? 1 : grown < 0.94 ? 2 : 3;

  flaws.light_on_left = happens(random, 0.5);
  flaws.baseline_m = stereo ? between_logs(random, 0.05, 0.1) : random.uniform(0.065, 0.085);
  flaws.least_light = happens(random, 0.15) ? 0 : between_logs(random, 0.01, 0.12);
  flaws.speckle = random.uniform(0.2, 0.7);
  flaws.steepest_degree = random.uniform(70, 84);
  return flaws;
}

EchoFlaws draw_echo(CounterRandom& random) {
  EchoFlaws flaws;
  flaws.noise = between_logs(random, 0.5, 3);
  flaws.wave = happens(random, 0.2) ? 0 : random.uniform(0.3, 1);
  flaws.wave_length_pixel = between_logs(random, 4, 30);
  flaws.frames = happens(random, 0.6) ? 1 : draw_integer(random, 2, 10);
  flaws.multipath = happens(random, 0.25) ? 0 : random.uniform(0.2, 1.5);
  flaws.blur_pixel = happens(random, 0.3) ? 0 : random.uniform(0.3, 1.2);
  flaws.wiggle_m = happens(random, 0.4) ? 0 : between_logs(random, 0.0005, 0.006);
  flaws.wiggle_period_m = random.uniform(0.3, 1.5);
  flaws.drops_edges = happens(random, 0.4);
  flaws.smoothing_pixel = happens(random, 0.5) ? 0 : draw_integer(random, 1, 3);
  flaws.smoothing_reach_m = between_logs(random, 0.005, 0.05);
  return flaws;
}

LineFlaws draw_line(CounterRandom& random) {
  LineFlaws flaws;
  flaws.noise = between_logs(random, 0.5, 3);
  flaws.wave = happens(random, 0.4) ? 0 : random.uniform(0.3, 1);
  flaws.wave_length_pixel = between_logs(random, 4, 30);
  flaws.beam_m = happens(random, 0.5) ? 0 : between_logs(random, 1e-4, 1e-3);
  return flaws;
}

/// Calibration errors of industrial scanners, which their manufacturers calibrate.
CalibrationFlaws tenth_of(CalibrationFlaws flaws) {
  flaws.focal /= 10;
  flaws.aspect /= 10;
  flaws.center_u_pixel /= 10;
  flaws.center_v_pixel /= 10;
  flaws.depth /= 10;
  flaws.shift_u_pixel = flaws.shift_v_pixel = 0;
  return flaws;
}

}  // namespace

SensorFlaws draw_flaws(Sensor sensor, CounterRandom& random) {
  SensorFlaws flaws;
  flaws.calibration = draw_calibration(random);
  flaws.patches = happens(random, 0.4) ? 0 : random.uniform(0.2, 1);
  flaws.patch_length_pixel = between_logs(random, 15, 80);
  flaws.holes = happens(random, 0.4) ? 0 : draw_integer(random, 5, 120);
  flaws.hole_radius_pixel = between_logs(random, 1.5, 8);
  if (sensor == Sensor::structured_light || sensor == Sensor::stereo)
    flaws.match = draw_match(sensor, random);
  if (sensor == Sensor::time_of_flight) flaws.echo = draw_echo(random);
  if (sensor == Sensor::laser) {
    flaws.line = draw_line(random);
    flaws.calibration = tenth_of(flaws.calibration);
  }
  return flaws;
}

Camera written_camera(const Camera& camera, const CalibrationFlaws& flaws) {
  Camera written = camera;
  written.fx *= (1 + flaws.focal) * (1 + flaws.aspect / 2);
  written.fy *= (1 + flaws.focal) * (1 - flaws.aspect / 2);
  written.cx += flaws.center_u_pixel;
  written.cy += flaws.center_v_pixel;
  return written;
}

Eigen::Matrix3d written_from_true(const Camera& camera, const CalibrationFlaws& flaws) {
  const Camera written = written_camera(camera, flaws);
  Eigen::Matrix3d pixels, image;  // transforms from rays to pixels, by both cameras
  pixels << camera.fx, 0, camera.cx + flaws.shift_u_pixel, 0, camera.fy,
      camera.cy + flaws.shift_v_pixel, 0, 0, 1;
  image << written.fx, 0, written.cx, 0, written.fy, written.cy, 0, 0, 1;
  return (1 + flaws.depth) * image.inverse() * pixels;
}

Pose written_pose(const Pose& T_camera_model, const Eigen::Vector3d& center, const Camera& camera,
                  const CalibrationFlaws& flaws) {
  if (flaws == CalibrationFlaws{}) return T_camera_model;
  const Eigen::Matrix3d map = written_from_true(camera, flaws);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(map, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose(),
                        rotation = turn * T_camera_model.linear().cast<double>();
  const Eigen::Vector3d place = map * (T_camera_model.cast<double>() * center);
  Pose out = Pose::Identity();
  out.linear() = rotation.cast<float>();
  out.translation() = (place - rotation * center).cast<float>();
  return out;
}

}  // namespace trivet::engine
