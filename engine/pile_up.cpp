#include "engine/pile_up.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernels/counter_random.hpp"
#include "kernels/height_field.hpp"

namespace trivet::engine {
namespace {

using kernels::CounterRandom;

constexpr int kTrials = 8;  // placements tried for each instance
constexpr float kHeapRadius =
    0.3F;  // in diameters, times the square root of the number of instances
constexpr float kCell =
    1.5F;  // in spacings of samples; neighbouring samples are hardly farther apart

/// Uniform over all rotations. Source: Shoemake, Graphics Gems III, 1992.
Eigen::Matrix3f random_rotation(CounterRandom& random) {
  const double u = random.uniform();
  const double a = random.uniform(0, 2 * std::numbers::pi),
               b = random.uniform(0, 2 * std::numbers::pi);
  const double r = std::sqrt(1 - u), s = std::sqrt(u);
  return Eigen::Quaterniond(s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b))
      .toRotationMatrix()
      .cast<float>();
}

/// A place in a disc, uniform by area.
Eigen::Vector3f random_place(CounterRandom& random, double radius) {
  const double r = radius * std::sqrt(random.uniform()),
               a = random.uniform(0, 2 * std::numbers::pi);
  return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), 0).cast<float>();
}

/// Every model once in a random order, then again in another.
std::vector<std::uint32_t> choose_models(std::size_t num_models, std::size_t num_instances,
                                         CounterRandom& random) {
  std::vector<std::uint32_t> chosen;
  std::vector<std::uint32_t> round(num_models);
  while (chosen.size() < num_instances) {
    for (std::size_t i = 0; i < num_models; ++i) round[i] = static_cast<std::uint32_t>(i);
    for (std::size_t i = num_models; i > 1; --i) std::swap(round[i - 1], round[random.next() % i]);
    chosen.insert(chosen.end(), round.begin(), round.end());
  }
  chosen.resize(num_instances);
  return chosen;
}

void transform(PointsView points, const Pose& pose, Points& out) {
  out.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out.set(i, pose * points[i]);
}

}  // namespace

std::vector<PlacedModel> pile_up(std::span<const Model> models, std::size_t num_instances,
                                 std::uint64_t seed, std::uint64_t stream) {
  assert(!models.empty() && "something to lay down");
  CounterRandom random(seed, stream, 0);
  float largest = 0, spacing = 0;
  for (const Model& model : models) {
    largest = std::max(largest, model.diameter);
    spacing = std::max(spacing, model.sample_spacing);
  }
  const float radius = kHeapRadius * largest * std::sqrt(static_cast<float>(num_instances));
  kernels::HeightField field(radius + largest, kCell * spacing);

  std::vector<PlacedModel> placed;
  Points samples;
  for (const std::uint32_t index : choose_models(models.size(), num_instances, random)) {
    const Model& model = models[index];
    PlacedModel best{index, Pose::Identity()};
    float lowest = std::numeric_limits<float>::infinity();
    for (int trial = 0; trial < kTrials; ++trial) {
      Pose pose = Pose::Identity();
      pose.linear() = random_rotation(random);
      pose.translation() =
          random_place(random, static_cast<double>(radius)) - pose.linear() * model.centre;
      transform(model.samples, pose, samples);
      const float lift = field.rest(samples);
      pose.translation().z() += lift;
      const float height = (pose * model.centre).z();
      if (height < lowest) {
        lowest = height;
        best.T_world_model = pose;
      }
    }
    transform(model.samples, best.T_world_model, samples);
    field.add(samples, 0);
    placed.push_back(best);
  }
  return placed;
}

}  // namespace trivet::engine
