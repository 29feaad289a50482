#include "parts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <stdexcept>

#include "engine/results/stage_times.hpp"
#include "engine/training/train.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/rendered_scene.hpp"

namespace trivet::bench {
namespace {

constexpr float kWallDepth = 1.4F;
constexpr std::uint32_t kSurfacePoints = 8192;

template <class T>
T require(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return std::move(*result);
}

Model train(const Part& part, const TrainOptions& options) {
  return require(train_model(test::cloud_of(part.shape), {part.name, part.name + ".ply", 1, {}},
                             options))
      .model;
}

Cloud render() {
  const test::Shape wall = test::box({-1, -1, kWallDepth}, {1, 1, kWallDepth + 0.1F});
  std::vector<test::Placed> placed{{&wall, Pose::Identity()}};
  for (const Part& part : parts()) placed.push_back({&part.shape, part.T_scene_part});
  Cloud scan = test::render_scan(placed);
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, 0.0005F);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3f p = scan.points[i];
    scan.points.set(i, p + noise(random) * p.normalized());
  }
  return scan;
}

/// The error of a part's pose relative to the truth.
struct PoseError {
  double diameters, degrees;
  bool right() const { return diameters < 0.1 && degrees < 12; }
};

PoseError pose_error(std::size_t part, const Pose& T_scene_part) {
  const Model& model = trained_parts(kDefaultStep)[part];
  const auto error =
      kernels::pose_distance(parts()[part].T_scene_part, T_scene_part, {}, model.center);
  return {double{error.translation / model.diameter},
          double{error.rotation_rad} * 180 / std::numbers::pi};
}

}  // namespace

const std::vector<Part>& parts() {
  static const std::vector<Part> all{
      {"bracket", test::bracket(), test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F})},
      {"lever", test::lever(), test::pose_of({-0.6F, 0.5F, 1.9F}, {0.12F, 0.02F, 0.95F})}};
  return all;
}

const std::vector<Model>& trained_parts(float relative_step) {
  static std::map<float, std::vector<Model>> all;
  const auto [entry, is_new] = all.try_emplace(relative_step);
  if (is_new) {
    for (const Part& part : parts())
      entry->second.push_back(train(part, {.relative_step = relative_step}));
  }
  return entry->second;
}

const Cloud& parts_scan() {
  static const Cloud scan = render();
  return scan;
}

const engine::PreparedScene& prepared_scan() {
  static const engine::PreparedScene scene = [] {
    StageTimes times;
    return require(engine::prepare_scene(parts_scan(), {}, times));
  }();
  return scene;
}

const OrientedPoints& part_surface(const Part& part) {
  static std::map<std::string, OrientedPoints> surfaces;
  const auto [entry, is_new] = surfaces.try_emplace(part.name);
  if (is_new) {
    const Model model = train(part, {.num_samples = kSurfacePoints});
    entry->second = {Points(model.samples), Normals(model.sample_normals)};
  }
  return entry->second;
}

const OrientedPoints& scan_without_wall() {
  static const OrientedPoints kept = [] {
    const engine::PreparedScene& scene = prepared_scan();
    OrientedPoints oriented;
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      if (scene.points[i].z() > kWallDepth - 0.01F || !std::isfinite(scene.normals[i].x()))
        continue;
      oriented.points.push_back(scene.points[i]);
      oriented.normals.push_back(scene.normals[i]);
    }
    return oriented;
  }();
  return kept;
}

void report_poses(benchmark::State& state, std::span<const std::optional<Pose>> T_scene_parts) {
  double num_right = 0;
  PoseError worst{0, 0};
  for (std::size_t k = 0; k < T_scene_parts.size(); ++k) {
    if (!T_scene_parts[k]) continue;
    const PoseError error = pose_error(k, *T_scene_parts[k]);
    num_right += error.right();
    worst = {std::max(worst.diameters, error.diameters), std::max(worst.degrees, error.degrees)};
  }
  state.counters["found"] = num_right;
  state.counters["expected"] = static_cast<double>(T_scene_parts.size());
  state.counters["translation_diameters"] = worst.diameters;
  state.counters["rotation_deg"] = worst.degrees;
}

const std::vector<Pose>& rough_poses() {
  static const std::vector<Pose> poses = [] {
    const Model& bracket = trained_parts(kDefaultStep)[0];
    const Pose truth = parts()[0].T_scene_part;
    std::mt19937 random(2);
    std::normal_distribution<float> normal;
    const auto direction = [&] {
      return Eigen::Vector3f(normal(random), normal(random), normal(random)).normalized();
    };
    std::vector<Pose> rough;
    for (int k = 0; k < 20; ++k) {
      const float angle = 5 * std::numbers::pi_v<float> / 180;
      rough.push_back(kernels::small_motion(angle * direction(),
                                            0.04F * bracket.diameter * direction(),
                                            truth * bracket.center) *
                      truth);
    }
    return rough;
  }();
  return poses;
}

void report_refined(benchmark::State& state, std::span<const Pose> T_scene_brackets) {
  PoseError sum{0, 0};
  for (const Pose& pose : T_scene_brackets) {
    const PoseError error = pose_error(0, pose);
    sum = {sum.diameters + error.diameters, sum.degrees + error.degrees};
  }
  const auto n = static_cast<double>(T_scene_brackets.size());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(T_scene_brackets.size()));
  state.counters["translation_diameters"] = sum.diameters / n;
  state.counters["rotation_deg"] = sum.degrees / n;
}

}  // namespace trivet::bench
