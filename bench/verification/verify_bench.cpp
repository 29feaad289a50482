// Verification of hypotheses against the scan, one after the other on one core: by samples before
// refinement, by rays after it. Items are hypotheses.
#include <benchmark/benchmark.h>

#include "kernels/verification/examine_pose.hpp"
#include "parts.hpp"

namespace trivet::bench {
namespace {

const Model& bracket() { return trained_parts(kDefaultStep)[0]; }

kernels::ModelSamples samples() {
  const Model& model = bracket();
  return {model.samples,        model.sample_normals, model.sample_views,
          model.sample_spacing, model.diameter,       model.center};
}

kernels::VerifyOptions options() {
  kernels::VerifyOptions options;
  options.tolerance = 0.016F * bracket().diameter;
  return options;
}

// The fraction of agreeing samples or pixels at poses 5 degrees and 0.04 diameters off.
void report(benchmark::State& state, double agreeing) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rough_poses().size()));
  state.counters["agreeing"] = agreeing;
}

void by_samples(benchmark::State& state) {
  double agreeing = 0;
  for (auto _ : state) {
    agreeing = 0;
    for (const Pose& pose : rough_poses()) {
      const kernels::Evidence evidence =
          kernels::verify_pose(prepared_scan().images, samples(),
                               static_cast<std::size_t>(state.range(0)), pose, options());
      agreeing += static_cast<double>(evidence.visible_fraction());
    }
  }
  report(state, agreeing / static_cast<double>(rough_poses().size()));
}
BENCHMARK(by_samples)->Name("verify/samples")->Arg(300)->Arg(2000);

void by_rays(benchmark::State& state) {
  const Model& model = bracket();
  const auto surface = kernels::RayScene::from_mesh(model.vertices, model.triangles);
  if (!surface) return state.SkipWithError(surface.error().message.c_str());
  kernels::ExamineOptions examine{options(), 2};
  kernels::ExamineScratch scratch;
  double agreeing = 0;
  for (auto _ : state) {
    agreeing = 0;
    for (const Pose& pose : rough_poses()) {
      const kernels::Examination found =
          kernels::examine_pose(prepared_scan().images, {*surface, samples(), pose},
                                model.symmetry.axis, examine, scratch);
      agreeing += static_cast<double>(found.consistent / found.covered);
    }
  }
  report(state, agreeing / static_cast<double>(rough_poses().size()));
}
BENCHMARK(by_rays)->Name("verify/rays");

}  // namespace
}  // namespace trivet::bench
