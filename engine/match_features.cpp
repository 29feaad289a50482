#include "engine/match_features.hpp"

#include <utility>

#include "engine/describe_surface.hpp"
#include "engine/parallel.hpp"
#include "kernels/keypoints_uniform.hpp"
#include "kernels/pca.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kGrain = 32;

struct MatchScratch {
  kernels::FeatureForest::Scratch forest;
  Column<float> features;
};

/// Leave at most so many, spread over all.
void thin_out(std::size_t limit, Column<std::uint32_t>& indices) {
  if (indices.size() <= limit) return;
  for (std::size_t k = 0; k < limit; ++k) indices[k] = indices[k * indices.size() / limit];
  indices.resize(limit);
}

}  // namespace

SceneMatches match_features(const TriSpinBasis& basis, const FeatureLevel& level,
                            const PreparedScene& scene, const SceneSample& sample,
                            std::span<const std::uint8_t> explained, const MatchOptions& options) {
  SceneMatches out;
  out.spacing = options.spacing * level.resolution;
  Column<std::uint32_t> keypoints;
  kernels::UniformScratch uniform;
  kernels::find_uniform_keypoints(sample.points, out.spacing, keypoints, uniform);
  if (!explained.empty()) {
    std::erase_if(keypoints, [&](std::uint32_t i) {
      return is_explained(scene, explained, sample.points[i], out.spacing);
    });
  }
  thin_out(options.max_keypoints, keypoints);
  Descriptions described;
  describe_surface(sample.points, sample.normals, keypoints, basis.support * level.resolution,
                   options.limits, described);

  const std::size_t k = basis.components.size(), matches = options.num_neighbours;
  std::vector<std::uint32_t> indices(described.size() * matches);
  std::vector<float> distances(indices.size());
  PerThread<MatchScratch> per_thread;
  for_chunks(described.size(), kGrain, [&](std::size_t first, std::size_t count) {
    MatchScratch& scratch = per_thread.local();
    scratch.features.resize(count * k);
    kernels::project(basis.components,
                     std::span(described.images)
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
    const auto s = static_cast<std::uint32_t>(m / matches);
    Pose pose = Pose::Identity();
    pose.linear() = described.frames[s].transpose() * level.frames[i];
    pose.translation() = described.keypoints[s] - pose.linear() * level.keypoints[i];
    out.matches.push_back({s, level.model[i], pose});
  }
  out.keypoints = std::move(described.keypoints);
  return out;
}

std::vector<std::vector<kernels::Hypothesis>> hypotheses_of(const SceneMatches& matches,
                                                            const PreparedScene& scene,
                                                            std::span<const std::uint8_t> explained,
                                                            std::size_t num_models) {
  std::vector<std::vector<kernels::Hypothesis>> hypotheses(num_models);
  for (const FeatureMatch& match : matches.matches) {
    if (!explained.empty() &&
        is_explained(scene, explained, matches.keypoints[match.keypoint], matches.spacing))
      continue;
    hypotheses[match.model].push_back({match.T_scene_model, 1});
  }
  return hypotheses;
}

}  // namespace trivet::engine
