#include "apps/service/serve/library/near_turns.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "apps/results/detections_json.hpp"
#include "apps/service/serve/library/model_json.hpp"
#include "kernels/symmetry/angles.hpp"
#include "kernels/symmetry/measure_deviation.hpp"
#include "kernels/symmetry/turn_axis.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kTurnsAboutAxis = 8;    // samples of a rotation by any angle
constexpr float kSameTurn = 0.02F;    // [rad]
constexpr float kSameShift = 0.005F;  // [diameters]

struct SampledModel {
  const ModelInfo& info;
  const ModelSamples& own;
};

/// How far a motion moves samples off the surface, and where the farthest sample ends.
struct Deviation {
  Pose motion = Pose::Identity();
  float median = 0, p90 = 0, largest = 0;
  Eigen::Vector3f place{0, 0, 0};
};

/// Measures both directions: what the moved surface has in excess, and what it lacks.
Deviation deviation_by(const SampledModel& model, const Pose& motion) {
  const std::size_t n = model.own.samples.size();
  std::vector<float> distances(2 * n);
  const std::array<Pose, 2> ways{motion, motion.inverse()};
  for (std::size_t way = 0; way < ways.size(); ++way) {
    kernels::measure_deviation(model.own.samples, model.own.sample_normals,
                               model.info.sample_spacing, ways[way],
                               std::span(distances).subspan(way * n, n));
  }
  Deviation deviation{.motion = motion};
  const auto farthest =
      static_cast<std::size_t>(std::ranges::max_element(distances) - distances.begin());
  deviation.largest = distances[farthest];
  const Eigen::Vector3f sample = model.own.samples[farthest % n];
  // What the moved surface lacks lies on the original surface.
  deviation.place = farthest < n ? Eigen::Vector3f(motion * sample) : sample;
  std::ranges::sort(distances);
  deviation.median = distances[n];
  deviation.p90 = distances[2 * n * 9 / 10];
  return deviation;
}

/// A rotation by any angle about the near axis, measured by the worst of some samples.
Deviation deviation_about(const SampledModel& model, const Symmetry::Axis& axis) {
  Deviation worst;
  for (int k = 1; k <= kTurnsAboutAxis; ++k) {
    const float angle = kernels::kGoldenAngle * static_cast<float>(k);
    const Deviation deviation = deviation_by(model, kernels::turn_about(axis, angle));
    if (deviation.largest > worst.largest) worst = deviation;
  }
  return worst;
}

bool are_same(const Pose& a, const Pose& b, float diameter) {
  const Pose between = a * b.inverse();
  return Eigen::AngleAxisf(Eigen::Matrix3f(between.linear())).angle() < kSameTurn &&
         between.translation().norm() < kSameShift * diameter;
}

/// All motions that declare a near rotation: it, its inverse, and both after each symmetry of the
/// model, so that the declaration omits no equivalent pose.
std::vector<Pose> declared_by(const ModelInfo& model, const Pose& motion) {
  std::vector<Pose> all;
  const auto add = [&](const Pose& pose) {
    const auto same = [&](const Pose& other) { return are_same(pose, other, model.diameter); };
    if (std::ranges::none_of(all, same)) all.push_back(pose);
  };
  for (const Pose& pose : {motion, motion.inverse()}) {
    add(pose);
    for (const Pose& symmetry : model.symmetry.poses) add(pose * symmetry);
  }
  return all;
}

Json turn_json(std::span<const Pose> motions, Json axis, const Deviation& deviation) {
  Json matrices = Json::array();
  for (const Pose& motion : motions) matrices.push_back(matrix_json(motion.cast<double>()));
  const Eigen::Vector3f& place = deviation.place;
  return {{"motions", std::move(matrices)},
          {"axis", std::move(axis)},
          {"measured", matrix_json(deviation.motion.cast<double>())},
          {"deviation",
           {{"median", deviation.median}, {"p90", deviation.p90}, {"largest", deviation.largest}}},
          {"place", std::array{place.x(), place.y(), place.z()}}};
}

Json turns_json(const SampledModel& sampled) {
  const ModelInfo& model = sampled.info;
  Json turns = Json::array();
  if (model.near_axis) {
    turns.push_back(turn_json({}, turn_axis_json(*model.near_axis, 0),
                              deviation_about(sampled, *model.near_axis)));
  }
  std::vector<Pose> listed;
  for (const Pose& motion : model.near_symmetries) {
    const auto same = [&](const Pose& other) { return are_same(motion, other, model.diameter); };
    if (std::ranges::any_of(listed, same)) continue;  // inverse of an earlier one
    const std::vector<Pose> all = declared_by(model, motion);
    listed.insert(listed.end(), all.begin(), all.end());
    const float angle = Eigen::AngleAxisf(Eigen::Matrix3f(motion.linear())).angle();
    turns.push_back(turn_json(all, turn_axis_json(kernels::axis_of(motion), angle),
                              deviation_by(sampled, motion)));
  }
  return {{"turns", std::move(turns)}};
}

}  // namespace

Result<Json> near_turns_json(const Library& library, std::uint32_t model) {
  TRIVET_TRY_ASSIGN(const ModelSamples* const samples, library.samples(model));
  return turns_json({library.models[model], *samples});
}

}  // namespace trivet::apps::service
