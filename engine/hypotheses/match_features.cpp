#include "engine/hypotheses/match_features.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/common/describe_surface.hpp"
#include "engine/common/parallel.hpp"
#include "engine/common/thin_out.hpp"
#include "engine/hypotheses/search_codes.hpp"
#include "engine/libraries/index_features.hpp"
#include "engine/scene/thin_by_pixels.hpp"
#include "kernels/common/projector.hpp"
#include "kernels/spin_images/feature_codes.hpp"
#include "kernels/spin_images/group_matches.hpp"
#include "kernels/spin_images/keypoints_uniform.hpp"
#include "kernels/spin_images/rotation_code.hpp"
#include "kernels/spin_images/salient_points.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kFeatureGrain = 32;
// Additional neighbors, at least one of which should be of another place.
constexpr std::size_t kMoreForRatio = 7;
// For groupings other than by frames.
constexpr std::size_t kMostGrouped = 3000;  // maximum number of matches per model
constexpr std::size_t kSmallestGroup = 3;
constexpr std::uint32_t kDraws = 20000;

struct MatchScratch {
  Column<float> numbers;
  Column<std::uint8_t> codes;
};

Column<std::uint32_t> find_keypoints(const SceneSample& sample, Detector detector, float spacing) {
  Column<std::uint32_t> keypoints;
  if (detector == Detector::uniform) {
    kernels::UniformScratch scratch;
    kernels::find_uniform_keypoints(sample.points, spacing, keypoints, scratch);
    return keypoints;
  }
  const kernels::VoxelHash grid(sample.points, spacing);
  std::vector<float> saliency(sample.points.size());
  if (detector == Detector::iss) {
    kernels::rate_by_iss(grid, sample.points, 2 * spacing, saliency);
  } else {
    kernels::rate_by_harris(grid, sample.points, sample.normals, 2 * spacing, saliency);
  }
  kernels::find_salient_points(grid, sample.points, saliency, spacing, keypoints);
  return keypoints;
}

/// Project images onto the library's components, as codes with the index's stride.
Column<std::uint8_t> encode_images(const TriSpinBasis& basis, std::span<const float> images) {
  const std::size_t n = images.size() / kernels::kTriSpinSize, k = basis.components.size();
  const std::size_t stride = kernels::code_stride(k);
  Column<std::uint8_t> padded(n * stride);
  const kernels::Projector projector(basis.components);
  PerThread<MatchScratch> per_thread;
  for_chunks(n, kFeatureGrain, [&](std::size_t first, std::size_t count) {
    MatchScratch& scratch = per_thread.local();
    scratch.numbers.resize(count * k);
    scratch.codes.resize(count * k);
    projector.project(images.subspan(first * kernels::kTriSpinSize, count * kernels::kTriSpinSize),
                      scratch.numbers);
    kernels::encode(scratch.numbers, basis.code_step, scratch.codes);
    kernels::pad_codes(scratch.codes, k, std::span(padded).subspan(first * stride, count * stride));
  });
  return padded;
}

/// Ratio of the distance of a feature's neighbor to that of its nearest neighbor of another model
/// or place. If all known neighbors are of this place, the farthest one is used.
///
/// neighbors  neighbors of the feature, sorted by distance
float ratio_to_other_place(const FeatureLevel& level,
                           std::span<const kernels::CodeNeighbor> neighbors, std::size_t of,
                           float place) {
  const std::uint32_t i = neighbors[of].index;
  const auto squared = static_cast<float>(neighbors[of].squared);
  float other = squared;
  for (const kernels::CodeNeighbor& neighbor : neighbors) {
    const std::uint32_t j = neighbor.index;
    if (j == kernels::CodeNeighbor::kNone) break;
    other = static_cast<float>(neighbor.squared);
    if (level.model[j] != level.model[i] ||
        (level.keypoints[j] - level.keypoints[i]).norm() > place)
      break;
  }
  return other > squared ? std::sqrt(squared / other) : 1;
}

}  // namespace

SceneMatches match_features(const TriSpinBasis& basis, const FeatureLevel& level,
                            const SampledScene& sampled, const MatchOptions& options,
                            const std::function<void()>& after_part) {
  const auto& [scene, sample, explained] = sampled;
  SceneMatches out;
  out.spacing = options.spacing * level.resolution;
  Column<std::uint32_t> keypoints = find_keypoints(sample, options.detector, out.spacing);
  if (!explained.empty()) {
    std::erase_if(keypoints, [&](std::uint32_t i) {
      return is_explained(sampled.scene, sampled.explained, sampled.sample.points[i], out.spacing);
    });
  }
  keypoints.resize(thin_by_pixels(scene, sample.points, options.max_keypoints, keypoints));
  const float support = basis.support * level.resolution;
  Descriptions described;
  describe_surface(sample.points, sample.normals, keypoints, support, options.limits, described);

  const bool needs_ratio = options.max_ratio < 1 || options.weigh_by_ratio;
  const CodeNeighbors found =
      search_codes(code_index(level), encode_images(basis, described.images), options.num_lists,
                   options.num_neighbors + (needs_ratio ? kMoreForRatio : 0), after_part);
  for (std::uint32_t s = 0; s < described.size(); ++s) {
    const std::span<const kernels::CodeNeighbor> neighbors = found.of(s);
    for (std::size_t of = 0; of < options.num_neighbors; ++of) {
      const std::uint32_t i = neighbors[of].index;
      const float distance = std::sqrt(static_cast<float>(neighbors[of].squared)) * basis.code_step;
      if (i == kernels::CodeNeighbor::kNone || distance > options.max_distance) break;
      const float ratio = needs_ratio ? ratio_to_other_place(level, neighbors, of, support / 2) : 0;
      if (options.max_ratio < 1 && ratio > options.max_ratio) continue;
      const float votes = options.weigh_by_ratio ? 1 - ratio : 1;
      if (!(votes > 0)) continue;
      Pose pose = Pose::Identity();
      pose.linear() = described.frames[s].transpose() * kernels::decode_rotation(level.frames[i]);
      pose.translation() = described.keypoints[s] - pose.linear() * level.keypoints[i];
      out.matches.push_back({s, level.model[i], level.keypoints[i], pose, votes});
    }
  }
  out.keypoints = std::move(described.keypoints);
  return out;
}

std::vector<std::vector<kernels::Hypothesis>> hypotheses_of(const SceneMatches& matches,
                                                            const PreparedScene& scene,
                                                            std::span<const std::uint8_t> explained,
                                                            std::size_t num_models,
                                                            Grouping grouping) {
  std::vector<std::vector<const FeatureMatch*>> of_model(num_models);
  for (const FeatureMatch& match : matches.matches) {
    if (match.model >= num_models) continue;  // the mapped file may be modified concurrently
    if (!explained.empty() &&
        is_explained(scene, explained, matches.keypoints[match.keypoint], matches.spacing))
      continue;
    of_model[match.model].push_back(&match);
  }
  std::vector<std::vector<kernels::Hypothesis>> hypotheses(num_models);
  for_each_index(num_models, [&](std::size_t m) {
    std::vector<const FeatureMatch*>& all = of_model[m];
    if (grouping == Grouping::frames) {
      for (const FeatureMatch* match : all)
        hypotheses[m].push_back({match->T_scene_model, match->votes});
      return;
    }
    std::ranges::stable_sort(all, std::ranges::greater(), &FeatureMatch::votes);
    thin_out(kMostGrouped, all);
    Points in_scene, in_model;
    for (const FeatureMatch* match : all) {
      in_scene.push_back(matches.keypoints[match->keypoint]);
      in_model.push_back(match->model_point);
    }
    const kernels::PointMatches points{in_scene, in_model};
    hypotheses[m] =
        grouping == Grouping::consistency
            ? kernels::group_by_consistency(points, matches.spacing, kSmallestGroup)
            : kernels::group_by_ransac(points, matches.spacing, kSmallestGroup, kDraws, m);
  });
  return hypotheses;
}

}  // namespace trivet::engine
