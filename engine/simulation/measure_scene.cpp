#include "engine/simulation/measure_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "engine/common/parallel.hpp"
#include "engine/simulation/echo_scene.hpp"
#include "engine/simulation/match_scene.hpp"
#include "engine/simulation/scan_constants.hpp"
#include "kernels/common/counter_random.hpp"
#include "kernels/scans/render_depth.hpp"
#include "kernels/simulation/noise_field.hpp"
#include "kernels/simulation/sensor_noise.hpp"
#include "kernels/surfaces/visibility.hpp"

namespace trivet {

namespace engine {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using kernels::CounterRandom;
using kernels::RayScene;

constexpr double kMinCosine = static_cast<double>(kernels::kMinViewCosine);
constexpr double kEdgeJump = 5;  // depth step at an edge, in widths of the laser line
constexpr double kMirrorAngle = 5 * kDegree, kGlintAngle = 10 * kDegree, kGlintNoise = 5;
constexpr std::uint64_t kFirstPixelItem = 16;  // lower items are the scene's random numbers
constexpr std::uint64_t kPixelFieldItem = 15ULL << 40, kHoleItem = 16ULL << 40;

/// Input for measuring one pixel.
class Pixels {
 public:
  Pixels(const ExactScene& scene, const SensorOptions& options, const LineFlaws& line,
         std::uint64_t seed, std::uint64_t stream)
      : rays_(scene.rays),
        camera_(scene.camera),
        image_(scene.image),
        finishes_(scene.finishes),
        echoes_(scene),
        sensor_(options.sensor),
        noise_(static_cast<double>(options.noise) * line.noise),
        traits_(traits_of(options.sensor)),
        disparity_step_(options.disparity_step_pixel
                            ? static_cast<double>(*options.disparity_step_pixel)
                            : traits_.disparity_step),
        beam_m_(line.beam_m) {
    if (line.wave > 0) {
      wave_height_ = line.wave;
      waves_.emplace(image_.width, image_.height, line.wave_length_pixel, seed, stream,
                     kPixelFieldItem);
    }
  }

  /// Measured depth [m]; 0 for none.
  double measure(std::size_t i, CounterRandom& random) const {
    const auto z = static_cast<double>(image_.depth[i]);
    if (z == 0) return 0;
    return sensor_ == Sensor::time_of_flight ? time_of_flight(i, random)
                                             : triangulate(i, z, random);
  }
  /// The depth, or 0 beyond the sensor's range.
  double in_range(double depth) const {
    return depth >= traits_.nearest && depth <= traits_.farthest ? depth : 0;
  }

 private:
  Vector3d ray(double u, double v) const {
    return {(u - camera_.cx) / camera_.fx, (v - camera_.cy) / camera_.fy, 1};
  }
  double column(std::size_t i) const { return static_cast<double>(i % image_.width); }
  double row(std::size_t i) const { return static_cast<double>(i / image_.width); }

  /// Depth error [m] if the center of the laser line is seen displaced at a depth edge: away from
  /// the side with the step, by up to half a line. Along the light, a point farther to the left is
  /// farther away.
  double edge_bias(std::size_t i, double z, CounterRandom& random) const {
    const std::size_t u = i % image_.width;
    const auto jumps = [&](std::size_t neighbor) {
      return std::abs(static_cast<double>(image_.depth[neighbor]) - z) > kEdgeJump * beam_m_;
    };
    const double side =
        (u + 1 < image_.width && jumps(i + 1) ? 1.0 : 0.0) - (u > 0 && jumps(i - 1) ? 1.0 : 0.0);
    return side * random.uniform(0, beam_m_ / 2) * z / traits_.baseline;
  }

  /// Depth by triangulation with a light or a second camera next to the camera.
  double triangulate(std::size_t i, double z, CounterRandom& random) const {
    const bool edge = at_edge(image_, camera_, i);
    if (edge && beam_m_ == 0) return 0;
    const Vector3d along = ray(column(i), row(i)), point = z * along, other(traits_.baseline, 0, 0),
                   to_camera = -along.normalized(), to_other = (other - point).normalized(),
                   normal = image_.normals[i].cast<double>();
    const double cosine = normal.dot(to_camera);
    if (cosine <= kMinCosine || normal.dot(to_other) <= kMinCosine) return 0;
    const double glint = glare(finishes_[image_.instance[i]], normal, to_other, to_camera);
    if (std::isinf(glint)) return 0;
    const Vector3f from = other.cast<float>(), reach = (point - other).cast<float>();
    if (rays_.occluded(from, reach, 0, static_cast<float>(1 - kBeforeSurface))) return 0;

    const double deviation = noise_ * glint * sigma(z, std::acos(std::min(cosine, 1.0)));
    double measured = z + deviation * random.normal();
    if (waves_) measured += deviation * wave_height_ * waves_->at(column(i), row(i));
    if (edge) measured += edge_bias(i, z, random);
    if (disparity_step_ > 0 && measured > 0) {
      measured =
          kernels::quantize_disparity(measured, camera_.fx, traits_.baseline, disparity_step_);
    }
    return measured;
  }

  double sigma(double z, double angle) const {
    if (sensor_ == Sensor::stereo) return kernels::stereo_sigma(z, camera_.fx, traits_.baseline);
    if (sensor_ == Sensor::laser) return kernels::laser_sigma(z, traits_.baseline);
    return kernels::structured_light_sigma(z, angle);
  }

  double time_of_flight(std::size_t i, CounterRandom& random) const {
    double glint = 1;
    const Echo echo = echoes_.direct(i, glint);
    if (std::isinf(glint)) return 0;
    return range_of(echo, noise_ * glint, random) / ray(column(i), row(i)).norm();
  }

  const RayScene& rays_;
  const Camera& camera_;
  const ExactImage& image_;
  std::span<const Finish> finishes_;
  Echoes echoes_;
  Sensor sensor_;
  double noise_;
  const SensorTraits& traits_;
  double disparity_step_, beam_m_, wave_height_ = 0;
  std::optional<kernels::NoiseField> waves_;
};

/// Processing of measured depths before they are written.
class Writer {
 public:
  Writer(std::uint32_t width, std::uint32_t height, const SensorFlaws& flaws, double depth_step)
      : width_(static_cast<int>(width)),
        height_(static_cast<int>(height)),
        flaws_(flaws),
        depth_step_(depth_step),
        stretch_(1 + flaws.calibration.depth) {}

  std::uint16_t raw(double depth) const {
    const double steps = std::round(stretch_ * depth / depth_step_);
    return steps >= 1 && steps <= 65535 ? static_cast<std::uint16_t>(steps) : std::uint16_t{0};
  }

  /// Remove ellipses of any orientation, as is usual for learning on rendered depth: Xie et al.,
  /// "Unseen object instance segmentation for robotic environments", T-RO 2021.
  void cut_holes(std::uint64_t seed, std::uint64_t stream, std::span<std::uint16_t> raws) const {
    for (std::uint32_t k = 0; k < flaws_.holes; ++k) {
      CounterRandom random(seed, stream, kHoleItem + k);
      const double u = random.uniform(0, width_), v = random.uniform(0, height_),
                   a = flaws_.hole_radius_pixel * -std::log(1 - random.uniform()),
                   b = a * random.uniform(0.3, 1), turn = random.uniform(0, std::numbers::pi);
      const int low_u = std::max(0, static_cast<int>(u - a)),
                low_v = std::max(0, static_cast<int>(v - a)),
                high_u = std::min(width_ - 1, static_cast<int>(u + a)),
                high_v = std::min(height_ - 1, static_cast<int>(v + a));
      for (int y = low_v; y <= high_v; ++y) {
        for (int x = low_u; x <= high_u; ++x) {
          const double along = (x - u) * std::cos(turn) + (y - v) * std::sin(turn),
                       across = (y - v) * std::cos(turn) - (x - u) * std::sin(turn);
          if (along * along * b * b + across * across * a * a <= a * a * b * b)
            raws[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                 static_cast<std::size_t>(x)] = 0;
        }
      }
    }
  }

  /// The image, shifted by the registration error.
  std::vector<std::uint16_t> shifted(std::vector<std::uint16_t> raws) const {
    const int du = flaws_.calibration.shift_u_pixel, dv = flaws_.calibration.shift_v_pixel;
    if (du == 0 && dv == 0) return raws;
    std::vector<std::uint16_t> out(raws.size());
    for (int v = std::max(0, dv); v < std::min(height_, height_ + dv); ++v) {
      for (int u = std::max(0, du); u < std::min(width_, width_ + du); ++u)
        out[static_cast<std::size_t>(v * width_ + u)] =
            raws[static_cast<std::size_t>((v - dv) * width_ + u - du)];
    }
    return out;
  }

 private:
  int width_, height_;
  const SensorFlaws& flaws_;
  double depth_step_, stretch_;
};

}  // namespace

bool at_edge(const ExactImage& image, const Camera& camera, std::size_t i) {
  // Maximum depth step between neighboring pixels on the steepest surface, relative to their
  // distance.
  static const double steepest = std::sqrt(1 - kMinCosine * kMinCosine) / kMinCosine;
  const auto z = static_cast<double>(image.depth[i]);
  const auto jumps = [&](std::size_t neighbor) {
    return std::abs(static_cast<double>(image.depth[neighbor]) - z) > steepest * z / camera.fx;
  };
  const std::size_t u = i % image.width, v = i / image.width;
  return (u > 0 && jumps(i - 1)) || (u + 1 < image.width && jumps(i + 1)) ||
         (v > 0 && jumps(i - image.width)) || (v + 1 < image.height && jumps(i + image.width));
}

double glare(const Finish& finish, const Vector3d& normal, const Vector3d& to_light,
             const Vector3d& to_camera) {
  if (!finish.metal) return 1;
  const double angle = kernels::mirror_angle(normal, to_light, to_camera);
  if (angle < kMirrorAngle) return std::numeric_limits<double>::infinity();
  return angle < kGlintAngle ? kGlintNoise : 1;
}

const SensorTraits& traits_of(Sensor sensor) {
  static constexpr std::array<SensorTraits, 4> kTraits{{
      {.baseline = 0.075, .disparity_step = 0, .depth_step = 1e-4, .nearest = 0.45, .farthest = 6},
      {.baseline = 0, .disparity_step = 0, .depth_step = 1e-4, .nearest = 0.3, .farthest = 6},
      {.baseline = 0.1,
       .disparity_step = 1.0 / 16,
       .depth_step = 1e-4,
       .nearest = 0.3,
       .farthest = 6},
      {.baseline = 0.2, .disparity_step = 0, .depth_step = 2e-5, .nearest = 0.5, .farthest = 1.3},
  }};
  return kTraits[static_cast<std::size_t>(sensor)];
}

ExactImage::ExactImage(std::uint32_t image_width, std::uint32_t image_height)
    : width(image_width),
      height(image_height),
      depth(std::size_t{width} * height),
      instance(depth.size()),
      normals(depth.size()) {}

ExactImage render_exactly(const RayScene& rays, const Camera& camera, std::uint32_t width,
                          std::uint32_t height) {
  ExactImage image(width, height);
  for_chunks(height, kRowGrain, [&](std::size_t first, std::size_t count) {
    const std::size_t begin = first * width, size = count * width;
    kernels::render_depth(
        rays, camera, width, static_cast<std::uint32_t>(first),
        {std::span(image.depth).subspan(begin, size),
         std::span(image.instance).subspan(begin, size), image.normals.span().slice(begin, size)});
  });
  return image;
}

std::vector<std::uint16_t> measure_scene(const ExactScene& scene, const SensorOptions& options,
                                         std::uint64_t seed, std::uint64_t stream,
                                         const SensorFlaws& flaws) {
  const ExactImage& image = scene.image;
  const SensorTraits& traits = traits_of(options.sensor);
  std::vector<float> depths;  // depths of a sensor with dependent pixels
  if (flaws.match.half_window_pixel > 0)
    depths = match_scene(scene, options, flaws, seed, stream);
  else if (flaws.echo != EchoFlaws{})
    depths = echo_scene(scene, options, flaws, seed, stream);
  const Pixels pixels(scene, options, flaws.line, seed, stream);
  const Writer writer(image.width, image.height, flaws, traits.depth_step);
  std::vector<std::uint16_t> out(image.depth.size());
  for_chunks(image.height, kRowGrain, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first * image.width; i < (first + count) * image.width; ++i) {
      CounterRandom random(seed, stream, kFirstPixelItem + i);
      out[i] = writer.raw(
          pixels.in_range(depths.empty() ? pixels.measure(i, random) : double{depths[i]}));
    }
  });
  writer.cut_holes(seed, stream, out);
  return writer.shifted(std::move(out));
}

}  // namespace engine
}  // namespace trivet
