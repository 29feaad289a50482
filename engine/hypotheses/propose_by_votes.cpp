#include "engine/hypotheses/propose_by_votes.hpp"

#include <cmath>
#include <utility>

#include "engine/common/checked_parts.hpp"
#include "engine/common/parallel.hpp"
#include "engine/common/thin_out.hpp"
#include "engine/hypotheses/find_hypotheses.hpp"
#include "engine/hypotheses/sample_for_models.hpp"
#include "storage/common/clamped_integer.hpp"

namespace trivet::engine {
namespace {

/// Keep the references whose model could lie within the limits.
void drop_far_references(const PoseLimits& limits, double scene_scale, float reach,
                         SceneLevel& level) {
  if (!limits.region) return;
  const auto scale = static_cast<float>(scene_scale);
  const Eigen::Array3f low = limits.region->low.cast<float>().array() * scale - reach;
  const Eigen::Array3f high = limits.region->high.cast<float>().array() * scale + reach;
  std::erase_if(level.references, [&](std::uint32_t i) {
    const Eigen::Array3f p = level.points[i].array();
    return !((p >= low).all() && (p <= high).all());
  });
}

/// Keep a share of the references of each level if more pairs of references and models would vote.
void bound_pairs(const ModelGroups& models, std::size_t max_pairs,
                 std::vector<SceneLevel>& levels) {
  std::size_t num_pairs = 0;
  auto level = levels.begin();
  for (const auto& [step, of_step] : models)
    num_pairs += (level++)->references.size() * of_step.size();
  if (num_pairs <= max_pairs) return;
  const double share = static_cast<double>(max_pairs) / static_cast<double>(num_pairs);
  for (SceneLevel& bounded : levels) {
    const std::size_t size = bounded.references.size();
    const double kept = std::ceil(share * static_cast<double>(size));
    thin_out(clamped_integer(kept, std::size_t{0}, size), bounded.references);
  }
}

}  // namespace

VoteSource::VoteSource(const Recognizer& recognizer, const PreparedScene& scene,
                       const ModelGroups& groups, LargePlanes large_planes, SceneStats& stats)
    : recognizer_(recognizer),
      scene_(scene),
      groups_(groups),
      large_planes_(large_planes),
      stats_(stats) {}

Result<std::vector<Proposals>> VoteSource::propose(const ModelGroups& models,
                                                   const VoteOptions& options,
                                                   std::size_t max_pairs, const PoseLimits& limits,
                                                   std::span<const std::uint8_t> explained) {
  const Library& library = recognizer_.library();
  std::vector<SceneLevel> levels = choose_all_voters(models, options, limits, explained);
  bound_pairs(models, max_pairs, levels);
  const StageTimer timer(stats_.times, "vote");
  std::vector<Proposals> proposals;
  auto level = levels.begin();
  for (const auto& [step, of_step] : models) {
    TRIVET_TRY_ASSIGN(const std::vector<const ModelPairs*> pairs, pairs_of(library, of_step));
    VotedHypotheses voted = find_hypotheses(pairs, *level++, options);
    stats_.num_references += voted.num_references;
    stats_.num_pairs += voted.num_pairs;
    stats_.num_votes += voted.num_votes;
    for (std::size_t m = 0; m < of_step.size(); ++m)
      proposals.push_back({of_step[m], Source::ppf, std::move(voted.of_model[m])});
  }
  recognizer_.release_memory();
  return proposals;
}

std::vector<SceneLevel> VoteSource::choose_all_voters(const ModelGroups& models,
                                                      const VoteOptions& options,
                                                      const PoseLimits& limits,
                                                      std::span<const std::uint8_t> explained) {
  const StageTimer timer(stats_.times, "subsample");
  std::vector<float> steps;
  for (const auto& [step, of_step] : models) {
    steps.push_back(step);
    samples_.try_emplace(step);
  }
  std::vector<SceneLevel> levels(steps.size());
  for_each_index(steps.size(), [&](std::size_t k) {
    SceneSample& sample = samples_.at(steps[k]);
    if (sample.points.size() == 0)
      sample = sample_for_models(recognizer_.library(), scene_, steps[k], groups_.at(steps[k]),
                                 large_planes_);
    levels[k] = choose_voters(scene_, sample, options, explained);
    drop_far_references(limits, scene_.scale, sample.largest_diameter, levels[k]);
  });
  return levels;
}

}  // namespace trivet::engine
