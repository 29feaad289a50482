#include "engine/match_features.hpp"

#include "engine/parallel.hpp"
#include "kernels/keypoints_uniform.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kGrain = 32;

struct MatchScratch {
  kernels::FeatureForest::Scratch forest;
  Column<float> features;
};

}  // namespace

std::vector<std::vector<kernels::Hypothesis>> match_features(const FeatureLibrary& library,
                                                             const FeatureLevel& level,
                                                             const SceneSample& sample,
                                                             std::size_t num_models,
                                                             const MatchOptions& options) {
  std::vector<std::vector<kernels::Hypothesis>> hypotheses(num_models);
  Column<std::uint32_t> keypoints;
  kernels::UniformScratch uniform;
  kernels::find_uniform_keypoints(sample.points, library.options.scene_spacing * level.resolution,
                                  keypoints, uniform);
  Descriptions scene;
  describe_surface(sample.points, sample.normals, keypoints,
                   library.options.support * level.resolution, library.options.limits, scene);

  const std::size_t k = library.basis.size(), matches = options.num_neighbours;
  std::vector<std::uint32_t> indices(scene.size() * matches);
  std::vector<float> distances(indices.size());
  PerThread<MatchScratch> per_thread;
  for_chunks(scene.size(), kGrain, [&](std::size_t first, std::size_t count) {
    MatchScratch& scratch = per_thread.local();
    scratch.features.resize(count * k);
    kernels::project(library.basis,
                     std::span(scene.images)
                         .subspan(first * kernels::kTriSpinSize, count * kernels::kTriSpinSize),
                     scratch.features);
    level.forest.k_nearest(scratch.features, matches, options.max_checks,
                           std::span(indices).subspan(first * matches, count * matches),
                           std::span(distances).subspan(first * matches, count * matches),
                           scratch.forest);
  });
  for (std::size_t m = 0; m < indices.size(); ++m) {
    const std::uint32_t i = indices[m];
    if (i == kernels::FeatureForest::kNone) continue;
    const std::size_t s = m / matches;
    Pose pose = Pose::Identity();
    pose.linear() = scene.frames[s].transpose() * level.frames[i];
    pose.translation() = scene.keypoints[s] - pose.linear() * level.keypoints[i];
    hypotheses[level.model[i]].push_back({pose, 1});
  }
  return hypotheses;
}

}  // namespace trivet::engine
