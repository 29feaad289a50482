// Training, refinement and recognition as a whole, on all cores. The CPU time of a row covers all
// its threads: compare it with PCL and OpenCV, which use one. The last part of a name is the
// sampling step in thousandths of the diameter.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "engine/recognition/recognize.hpp"
#include "engine/training/train.hpp"
#include "kernels/verification/refine_pose.hpp"
#include "parts.hpp"
#include "support/rendered_scene.hpp"

namespace trivet::bench {
namespace {

float relative_step(const benchmark::State& state) {
  return static_cast<float>(state.range(0)) / 1000;
}

// Training of a model from its mesh: samples, visibility, symmetry, points and table.
void train_ours(benchmark::State& state) {
  const Part& bracket = parts()[0];
  const Cloud mesh = test::cloud_of(bracket.shape);
  const ModelSource source{bracket.name, bracket.name + ".ply", 1, {}};
  const TrainOptions options{.relative_step = relative_step(state)};
  TrainStats stats;
  for (auto _ : state) {
    auto trained = train_model(mesh, source, options);
    if (!trained) return state.SkipWithError(trained.error().message.c_str());
    stats = std::move(trained->stats);
  }
  state.counters["points"] = static_cast<double>(stats.num_ppf_points);
  state.counters["pairs"] = static_cast<double>(stats.num_ppf_entries);
}
BENCHMARK(train_ours)
    ->Name("train/ours")
    ->Arg(100)
    ->Arg(70)
    ->Arg(50)
    ->Arg(40)
    ->Arg(25)
    ->Apply(measure_process_time);

void refine_ours(benchmark::State& state) {
  const Model& bracket = trained_parts(kDefaultStep)[0];
  const kernels::ModelSamples samples{bracket.samples,      bracket.sample_normals,
                                      bracket.sample_views, bracket.sample_spacing,
                                      bracket.diameter,     bracket.center};
  kernels::RefineOptions options;
  options.num_samples = 500;
  options.first_gate = 0.06F * bracket.diameter;
  options.last_gate = 0.016F * bracket.diameter;
  options.max_translation = 0.1F * bracket.diameter;
  std::vector<Pose> refined(rough_poses().size());
  const auto refine = [&](const Pose& rough) {
    return kernels::refine_pose(prepared_scan().images, samples, rough, options).T_scene_model;
  };
  for (auto _ : state) std::ranges::transform(rough_poses(), refined.begin(), refine);
  report_refined(state, refined);
}
BENCHMARK(refine_ours)->Name("icp/ours")->Apply(measure_process_time);

// Recognition from the scan to verified poses of both parts: normals, planes, sampling, voting,
// refinement, selection.
void recognize_ours(benchmark::State& state) {
  const Recognizer recognizer(Library(trained_parts(relative_step(state))));
  SceneResult result;
  for (auto _ : state) {
    auto found = recognize(recognizer, parts_scan(), {}, {});
    if (!found) return state.SkipWithError(found.error().message.c_str());
    result = std::move(*found);
  }
  std::vector<std::optional<Pose>> poses(parts().size());
  for (const Detection& detection : result.detections) {
    const auto part = std::ranges::find(parts(), detection.model, &Part::name) - parts().begin();
    std::optional<Pose>& best = poses[static_cast<std::size_t>(part)];
    if (!best) best = detection.T_scene_model;  // detections are sorted by descending score
  }
  report_poses(state, poses);
  state.counters["false"] = static_cast<double>(result.detections.size()) - state.counters["found"];
}
BENCHMARK(recognize_ours)
    ->Name("recognize/ours")
    ->Arg(100)
    ->Arg(70)
    ->Arg(40)
    ->Apply(measure_process_time);

}  // namespace
}  // namespace trivet::bench
