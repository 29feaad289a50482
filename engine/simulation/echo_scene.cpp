#include "engine/simulation/echo_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/common/parallel.hpp"
#include "engine/simulation/scan_constants.hpp"
#include "kernels/simulation/filter_image.hpp"
#include "kernels/simulation/noise_field.hpp"
#include "kernels/simulation/sensor_noise.hpp"

namespace trivet::engine {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using kernels::CounterRandom;

constexpr double kLeastSignal = 0.02;    // gray at 88 degrees from 0.7 m, white from 6 m
constexpr int kSubpixels = 4;            // rays along each side of a pixel at a depth edge
constexpr std::size_t kNodeSpacing = 4;  // spacing of the nodes for bounced light [pixel]
constexpr int kBounces = 16;             // rays per node
constexpr double kAlike = 0.9;           // minimum cosine between normals that share bounced light
constexpr double kLeastCosine = 0.1;     // on steeper surfaces bounced light grows no further
// Separate streams of random numbers, each large enough for an image.
enum Item : std::uint64_t {
  kNoiseItem = 6ULL << 40,
  kBounceItem = 7ULL << 40,
  kRangeFieldItem = 8ULL << 40,
  kPatchItem = 9ULL << 40,
  kWiggleItem = 10ULL << 40
};

/// Bounced light at every kNodeSpacing-th pixel of every kNodeSpacing-th row.
class BouncedLight {
 public:
  BouncedLight(const Echoes& echoes, const ExactImage& image, std::uint64_t seed,
               std::uint64_t stream)
      : image_(image),
        columns_((image.width - 1) / kNodeSpacing + 1),
        nodes_(columns_ * ((image.height - 1) / kNodeSpacing + 1)) {
    for_chunks(nodes_.size() / columns_, 4, [&](std::size_t first, std::size_t count) {
      for (std::size_t k = first * columns_; k < (first + count) * columns_; ++k) {
        CounterRandom random(seed, stream, kBounceItem + k);
        if (image.depth[pixel_of(k)] > 0) nodes_[k] = echoes.bounced(pixel_of(k), kBounces, random);
      }
    });
  }

  /// Interpolate between the surrounding nodes on a similar surface; without such nodes there is no
  /// light.
  Echo at(std::size_t i) const {
    const std::size_t u = i % image_.width, v = i / image_.width;
    const std::size_t column = u / kNodeSpacing, row = v / kNodeSpacing;
    Echo sum;
    double weights = 0;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const std::size_t x = column + corner % 2, y = row + corner / 2;
      if (x >= columns_ || y * columns_ >= nodes_.size()) continue;
      const std::size_t node = y * columns_ + x, j = pixel_of(node);
      if (image_.instance[j] != image_.instance[i] ||
          image_.normals[i].dot(image_.normals[j]) < static_cast<float>(kAlike)) {
        continue;
      }
      const auto distance = [](std::size_t a, std::size_t b) {
        return std::abs(static_cast<double>(a) - static_cast<double>(b)) / kNodeSpacing;
      };
      const double weight =
          (1 - distance(x * kNodeSpacing, u)) * (1 - distance(y * kNodeSpacing, v));
      weights += weight;
      sum.light += weight * nodes_[node].light;
      sum.moment += weight * nodes_[node].moment;
    }
    if (weights == 0) return {};
    return {sum.light / weights, sum.moment / weights};
  }

 private:
  std::size_t pixel_of(std::size_t node) const {
    return node / columns_ * kNodeSpacing * image_.width + node % columns_ * kNodeSpacing;
  }

  const ExactImage& image_;
  std::size_t columns_;
  std::vector<Echo> nodes_;
};

/// Blur light along rows (stride 1) or columns, with binomial-like weights of a Gaussian over five
/// pixels.
Echo blurred(std::span<const Echo> echoes, std::size_t i, std::size_t place, std::size_t size,
             std::size_t stride, std::span<const double, 3> weights) {
  Echo out{weights[0] * echoes[i].light, weights[0] * echoes[i].moment};
  for (std::size_t k = 1; k <= 2; ++k) {
    // Replicates the border.
    const Echo& before = echoes[i - std::min(k, place) * stride];
    const Echo& after = echoes[i + std::min(k, size - 1 - place) * stride];
    out.light += weights[k] * (before.light + after.light);
    out.moment += weights[k] * (before.moment + after.moment);
  }
  return out;
}

std::array<double, 3> gaussian(double sigma) {
  std::array<double, 3> weights{1, std::exp(-0.5 / (sigma * sigma)),
                                std::exp(-2 / (sigma * sigma))};
  const double sum = weights[0] + 2 * (weights[1] + weights[2]);
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace

Echo Echoes::direct(std::size_t i, double& glint) const {
  glint = 1;
  if (at_edge(image_, camera_, i)) return subpixel_echo(i);
  const Vector3d along = ray(i), to_camera = -along.normalized(),
                 normal = image_.normals[i].cast<double>();
  const Finish& finish = finishes_[image_.instance[i]];
  glint = glare(finish, normal, to_camera, to_camera);
  const double range = static_cast<double>(image_.depth[i]) * along.norm();
  Echo echo;
  echo.add(range, kernels::time_of_flight_signal(range, normal.dot(to_camera), finish.reflectance));
  return echo;
}

Echo Echoes::subpixel_echo(std::size_t i) const {
  Echo echo;
  const auto column = static_cast<double>(i % image_.width),
             row = static_cast<double>(i / image_.width);
  for (int k = 0; k < kSubpixels * kSubpixels; ++k) {
    const double u = (k % kSubpixels + 0.5) / kSubpixels - 0.5,
                 v = (k / kSubpixels + 0.5) / kSubpixels - 0.5;  // NOLINT: whole rows
    const Vector3d along = ray(column + u, row + v).normalized();
    const kernels::Hit hit = rays_.intersect(Vector3f::Zero(), along.cast<float>(), 0,
                                             std::numeric_limits<float>::infinity());
    if (!hit) continue;
    const auto range = static_cast<double>(hit.distance);
    echo.add(range,
             kernels::time_of_flight_signal(range, std::abs(hit.normal.cast<double>().dot(along)),
                                            finishes_[hit.instance].reflectance) /
                 (kSubpixels * kSubpixels));
  }
  return echo;
}

Echo Echoes::bounced(std::size_t i, int num_rays, CounterRandom& random) const {
  const Vector3d along = ray(i), point = static_cast<double>(image_.depth[i]) * along,
                 normal = image_.normals[i].cast<double>();
  const double range = point.norm(),
               cosine = std::max(kLeastCosine, -normal.dot(along.normalized())),
               own = kernels::time_of_flight_signal(range, cosine, 1);
  const Vector3d across = normal.unitOrthogonal(), aside = normal.cross(across);
  Echo echo;
  for (int k = 0; k < num_rays; ++k) {
    // Sample directions in proportion to the light from them on a diffuse surface (Malley's
    // method).
    const double turn = random.uniform(0, kTurn), square = random.uniform();
    const Vector3d direction =
        std::sqrt(square) * (std::cos(turn) * across + std::sin(turn) * aside) +
        std::sqrt(1 - square) * normal;
    const kernels::Hit hit =
        rays_.intersect(point.cast<float>(), direction.cast<float>(),
                        static_cast<float>(1e-3 * range), std::numeric_limits<float>::infinity());
    if (!hit) continue;
    const Vector3d other = point + static_cast<double>(hit.distance) * direction;
    if (other.z() <= 0) continue;
    // The light is at the lens, so lit surfaces are the visible ones.
    const double u = std::round(camera_.fx * other.x() / other.z() + camera_.cx),
                 v = std::round(camera_.fy * other.y() / other.z() + camera_.cy);
    if (!(u >= 0 && v >= 0 && u < image_.width && v < image_.height)) continue;
    const auto depth = static_cast<double>(
        image_.depth[static_cast<std::size_t>(v) * image_.width + static_cast<std::size_t>(u)]);
    if (other.z() > 1.02 * depth) continue;
    const double way = other.norm();
    const double light =
        kernels::time_of_flight_signal(way, std::abs(hit.normal.cast<double>().dot(other)) / way,
                                       finishes_[hit.instance].reflectance) /
        (own * num_rays);
    // Half of the whole path to the surfaces and back.
    echo.add((way + static_cast<double>(hit.distance) - range) / 2, light);
  }
  return echo;
}

double range_of(const Echo& echo, double noise, CounterRandom& random) {
  if (!(echo.light > kLeastSignal)) return 0;
  return echo.moment / echo.light +
         noise * kernels::time_of_flight_sigma(echo.light) * random.normal();
}

std::vector<float> echo_scene(const ExactScene& scene, const SensorOptions& options,
                              const SensorFlaws& flaws, std::uint64_t seed, std::uint64_t stream) {
  const EchoFlaws& flaw = flaws.echo;
  const ExactImage& image = scene.image;
  const Echoes echoes(scene);
  const std::size_t width = image.width, height = image.height;
  std::vector<Echo> light(image.depth.size());
  std::vector<double> glints(light.size(), std::numeric_limits<double>::infinity());
  // Call body(pixel) for each pixel.
  const auto for_pixels = [&](auto&& body) {
    for_chunks(height, kRowGrain, [&](std::size_t first, std::size_t count) {
      for (std::size_t i = first * width; i < (first + count) * width; ++i) body(i);
    });
  };

  const kernels::NoiseField print(image.width, image.height, flaws.patch_length_pixel, seed, stream,
                                  kPatchItem);
  std::optional<BouncedLight> bounced;
  if (flaw.multipath > 0) bounced.emplace(echoes, image, seed, stream);
  for_pixels([&](std::size_t i) {
    if (image.depth[i] == 0) return;
    Echo echo = echoes.direct(i, glints[i]);
    if (flaw.drops_edges && at_edge(image, scene.camera, i))
      glints[i] = std::numeric_limits<double>::infinity();
    if (bounced) {
      const Echo more = bounced->at(i);
      const double range = echo.light > 0 ? echo.moment / echo.light : 0;
      echo.moment += echo.light * flaw.multipath * (more.moment + range * more.light);
      echo.light += echo.light * flaw.multipath * more.light;
    }
    if (flaws.patches > 0) {
      const double share = std::exp(
          flaws.patches * print.at(static_cast<double>(i % width), static_cast<double>(i / width)));
      echo.light *= share;
      echo.moment *= share;
    }
    light[i] = echo;
  });
  if (flaw.blur_pixel > 0) {
    const std::array<double, 3> weights = gaussian(flaw.blur_pixel);
    std::vector<Echo> next(light.size());
    for_pixels([&](std::size_t i) { next[i] = blurred(light, i, i % width, width, 1, weights); });
    for_pixels(
        [&](std::size_t i) { light[i] = blurred(next, i, i / width, height, width, weights); });
  }

  const kernels::NoiseField waves(image.width, image.height, flaw.wave_length_pixel, seed, stream,
                                  kRangeFieldItem);
  const double phase = CounterRandom(seed, stream, kWiggleItem).uniform(0, kTurn),
               strength = static_cast<double>(options.noise) * flaw.noise,
               white = strength / std::sqrt(flaw.frames);
  std::vector<float> ranges(light.size());
  for_pixels([&](std::size_t i) {
    if (std::isinf(glints[i])) return;
    CounterRandom random(seed, stream, kNoiseItem + i);
    double range = range_of(light[i], white * glints[i], random);
    if (!(range > 0)) return;
    range += flaw.wiggle_m * std::sin(kTurn * range / flaw.wiggle_period_m + phase);
    if (flaw.wave > 0) {
      range += strength * flaw.wave * kernels::time_of_flight_sigma(light[i].light) *
               waves.at(static_cast<double>(i % width), static_cast<double>(i / width));
    }
    ranges[i] = static_cast<float>(std::max(range, 0.0));
  });
  if (flaw.smoothing_pixel > 0) {
    std::vector<float> next(ranges.size());
    for (const kernels::Along along : {kernels::Along::rows, kernels::Along::columns}) {
      for_chunks(height, kRowGrain, [&](std::size_t first, std::size_t count) {
        kernels::smooth_image({ranges, image.width}, static_cast<std::uint32_t>(first), along,
                              flaw.smoothing_pixel, static_cast<float>(flaw.smoothing_reach_m),
                              std::span(next).subspan(first * width, count * width));
      });
      std::swap(ranges, next);
    }
  }
  for_pixels([&](std::size_t i) {
    ranges[i] = static_cast<float>(static_cast<double>(ranges[i]) / echoes.ray(i).norm());
  });
  return ranges;
}

}  // namespace trivet::engine
