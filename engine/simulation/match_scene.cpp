#include "engine/simulation/match_scene.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "engine/common/parallel.hpp"
#include "engine/simulation/scan_constants.hpp"
#include "kernels/common/counter_random.hpp"
#include "kernels/simulation/filter_image.hpp"
#include "kernels/simulation/match_windows.hpp"
#include "kernels/simulation/noise_field.hpp"
#include "kernels/simulation/sensor_noise.hpp"

namespace trivet::engine {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using kernels::CounterRandom;

/// Individual dots, and errors added to the results of windows.
class Matcher {
 public:
  Matcher(const ExactScene& scene, const SensorOptions& options, const SensorFlaws& flaws,
          std::uint64_t seed, std::uint64_t stream)
      : rays_(scene.rays),
        camera_(scene.camera),
        image_(scene.image),
        finishes_(scene.finishes),
        match_(flaws.match),
        patches_(flaws.patches),
        seed_(seed),
        stream_(stream),
        fb_(camera_.fx * baseline(flaws.match, options.sensor)),
        light_((flaws.match.light_on_left ? -1 : 1) * baseline(flaws.match, options.sensor), 0, 0),
        min_cosine_(std::cos(flaws.match.steepest_degree * kDegree)),
        waves_(image_.width, image_.height, flaws.match.wave_length_pixel, seed, stream,
               kNoiseFieldItem),
        print_(image_.width, image_.height, flaws.patch_length_pixel, seed, stream, kPatchItem) {
    // The part of the noise that differs between frames decreases with their number.
    const double noise = static_cast<double>(options.noise) * match_.noise_pixel,
                 own = match_.frame_share / match_.frames,
                 dots = match_.dot_share * std::pow(2 * match_.half_window_pixel + 1, 2),
                 shared = 1 - match_.white_share;
    pattern_noise_ = noise * std::sqrt(dots * shared * (1 - match_.frame_share));
    frame_noise_ = noise * std::sqrt(dots * shared * own);
    white_noise_ = noise * std::sqrt(match_.white_share / match_.frames);
    wave_height_ = static_cast<double>(options.noise) * match_.wave_pixel;
    ripple_phase_ = CounterRandom(seed, stream, kRippleItem).uniform(0, kTurn);
    step_pixel_ = options.disparity_step_pixel ? static_cast<double>(*options.disparity_step_pixel)
                                               : match_.step_pixel;
  }

  /// Disparity of a pixel's dot for the matcher [pixel].
  float dot(std::size_t i) const {
    CounterRandom random(seed_, stream_, kDotItem + i);
    if (random.uniform() >= match_.dot_share) return kernels::kNoDot;
    const auto z = static_cast<double>(image_.depth[i]);
    if (z == 0) return kernels::kHiddenDot;
    const double pattern = random.normal(), frame = random.normal(),
                 speckle = std::exp(match_.speckle * random.normal());
    const double glint = glint_of(i, z, speckle);
    if (!std::isfinite(glint)) return kernels::kHiddenDot;
    const double disparity = fb_ / z + glint * (pattern_noise_ * pattern + frame_noise_ * frame);
    return disparity > 0 ? static_cast<float>(disparity) : kernels::kHiddenDot;
  }

  /// Disparity with the errors added to a window's result [pixel].
  double disturb(std::size_t i, double disparity) const {
    CounterRandom random(seed_, stream_, kWhiteItem + i);
    const auto u = static_cast<double>(i % image_.width), v = static_cast<double>(i / image_.width);
    if (wave_height_ > 0) disparity += wave_height_ * waves_.at(u, v);
    if (match_.ripple_pixel > 0)
      disparity += match_.ripple_pixel * std::sin(kTurn * disparity + ripple_phase_);
    return std::max(disparity + white_noise_ * random.normal(), 0.0);
  }

  /// Depth of a disparity [m]; 0 for none.
  float depth(double disparity) const {
    if (step_pixel_ > 0) disparity = step_pixel_ * std::round(disparity / step_pixel_);
    return disparity > 0 ? static_cast<float>(fb_ / disparity) : 0;
  }

 private:
  // Separate streams of random numbers, each large enough for an image.
  enum Item : std::uint64_t {
    kDotItem = 1ULL << 40,
    kWhiteItem = 2ULL << 40,
    kNoiseFieldItem = 3ULL << 40,
    kPatchItem = 4ULL << 40,
    kRippleItem = 5ULL << 40
  };

  static double baseline(const MatchFlaws& match, Sensor sensor) {
    return match.baseline_m > 0 ? match.baseline_m : traits_of(sensor).baseline;
  }

  /// Factor of a dot's noise due to mirrored light; infinite: the dot is not visible.
  double glint_of(std::size_t i, double z, double speckle) const {
    constexpr double kHidden = std::numeric_limits<double>::infinity();
    const auto u = static_cast<double>(i % image_.width), v = static_cast<double>(i / image_.width);
    const Vector3d along((u - camera_.cx) / camera_.fx, (v - camera_.cy) / camera_.fy, 1),
        point = z * along, to_camera = -along.normalized(),
        to_light = (light_ - point).normalized(), normal = image_.normals[i].cast<double>();
    const double lit = normal.dot(to_light);
    if (normal.dot(to_camera) <= min_cosine_ || lit <= min_cosine_) return kHidden;
    const Finish& finish = finishes_[image_.instance[i]];
    const double print = patches_ > 0 ? std::exp(patches_ * print_.at(u, v)) : 1;
    if (finish.reflectance * print * speckle * lit / (z * z) < match_.least_light) return kHidden;
    const double glint = glare(finish, normal, to_light, to_camera);
    if (!std::isfinite(glint)) return kHidden;
    const Vector3f from = light_.cast<float>(), reach = (point - light_).cast<float>();
    return rays_.occluded(from, reach, 0, static_cast<float>(1 - kBeforeSurface)) ? kHidden : glint;
  }

  const kernels::RayScene& rays_;
  const Camera& camera_;
  const ExactImage& image_;
  std::span<const Finish> finishes_;
  const MatchFlaws& match_;
  double patches_;
  std::uint64_t seed_, stream_;
  double fb_;       // focal length times baseline [pixel m]
  Vector3d light_;  // position of the projector or second camera
  double min_cosine_;
  kernels::NoiseField waves_, print_;
  double pattern_noise_, frame_noise_, white_noise_, wave_height_, ripple_phase_, step_pixel_;
};

}  // namespace

std::vector<float> match_scene(const ExactScene& scene, const SensorOptions& options,
                               const SensorFlaws& flaws, std::uint64_t seed, std::uint64_t stream) {
  const ExactImage& image = scene.image;
  const Matcher matcher(scene, options, flaws, seed, stream);
  const MatchFlaws& match = flaws.match;
  std::vector<float> now(image.depth.size()), next(now.size());
  // Apply body(first_row, rows of the output) to the image.
  const auto pass = [&](auto&& body) {
    for_chunks(image.height, kRowGrain, [&](std::size_t first, std::size_t count) {
      body(static_cast<std::uint32_t>(first),
           std::span(next).subspan(first * image.width, count * image.width));
    });
    std::swap(now, next);
  };

  pass([&](std::uint32_t row, std::span<float> out) {
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = matcher.dot(std::size_t{row} * image.width + i);
  });
  const kernels::WindowMatching windows{.half_window = match.half_window_pixel,
                                        .taper = static_cast<float>(match.taper),
                                        .reach_pixel = static_cast<float>(match.reach_pixel),
                                        .fewest_dots = match.fewest_dots,
                                        .least_share = static_cast<float>(match.least_share)};
  pass([&](std::uint32_t row, std::span<float> out) {
    kernels::match_windows(now, image.width, row, windows, out);
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i] == 0) continue;
      out[i] = static_cast<float>(
          matcher.disturb(std::size_t{row} * image.width + i, static_cast<double>(out[i])));
    }
  });
  if (match.median_pixel > 0) {
    pass([&](std::uint32_t row, std::span<float> out) {
      kernels::median_image({now, image.width}, row, match.median_pixel, out);
    });
  }
  const auto reach = static_cast<float>(match.smoothing_reach_pixel);
  for (const kernels::Along along : {kernels::Along::rows, kernels::Along::columns}) {
    if (match.smoothing_pixel == 0) break;
    pass([&](std::uint32_t row, std::span<float> out) {
      kernels::smooth_image({now, image.width}, row, along, match.smoothing_pixel, reach, out);
    });
  }
  if (match.block_pixel > 1) {
    pass([&](std::uint32_t row, std::span<float> out) {
      kernels::coarsen_image({now, image.width}, row, match.block_pixel, out);
    });
  }
  if (match.grow_pixel > 0) {
    pass([&](std::uint32_t row, std::span<float> out) {
      kernels::grow_image({now, image.width}, row, match.grow_pixel,
                          static_cast<float>(match.grow_jump_pixel), out);
    });
  }
  if (match.fill_pixel > 0) {
    pass([&](std::uint32_t row, std::span<float> out) {
      kernels::fill_image({now, image.width}, row, match.fill_pixel,
                          match.fills_near ? kernels::Fill::most : kernels::Fill::least, out);
    });
  }
  for (float& value : now) value = matcher.depth(static_cast<double>(value));
  return now;
}

}  // namespace trivet::engine
