#include "engine/hypotheses/propose_by_matches.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "engine/hypotheses/sample_for_models.hpp"

namespace trivet::engine {

Result<std::vector<Proposals>> MatchSource::propose(const MatchOptions& options,
                                                    const MatchLevels& levels,
                                                    std::span<const std::uint8_t> explained) {
  const StageTimer timer(stats_.times, "match");
  if (!std::exchange(is_matched_, true)) TRIVET_TRY(match(options, levels, explained));
  std::vector<Proposals> proposals;
  for (const SceneMatches& matches : matches_) {
    std::vector<std::vector<kernels::Hypothesis>> hypotheses = hypotheses_of(
        matches, scene_, explained, recognizer_.library().models.size(), options.grouping);
    for (const std::uint32_t m : models_) {
      if (!hypotheses[m].empty()) proposals.push_back({m, Source::trisi, std::move(hypotheses[m])});
    }
  }
  return proposals;
}

Result<void> MatchSource::match(const MatchOptions& options, const MatchLevels& levels,
                                std::span<const std::uint8_t> explained) {
  const Library& library = recognizer_.library();
  const Result<const FeatureLevels*> index = recognizer_.features();
  if (!index) return index.error();
  for (std::size_t k = 0; k < (*index)->size(); ++k) {
    const LevelShape shape = (*index)->shape(k);
    if (shape.resolution < levels.finest) continue;
    std::vector<std::uint32_t> models;
    std::ranges::set_intersection(shape.models, models_, std::back_inserter(models));
    const bool is_own = std::ranges::any_of(models, [&](std::uint32_t m) {
      return library.shape(m).features[0].resolution == shape.resolution;
    });
    if (models.empty() || (levels.only_own && !is_own)) continue;
    TRIVET_TRY_ASSIGN(const FeatureLevel* const level, (*index)->level(k));
    const SceneSample sample =
        sample_for_models(library, scene_, shape.resolution, models, large_planes_);
    matches_.push_back(match_features(library.basis, *level, {scene_, sample, explained}, options,
                                      [&] { recognizer_.release_memory(); }));
    recognizer_.release_memory();
  }
  return {};
}

}  // namespace trivet::engine
