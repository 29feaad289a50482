#include "engine/hypotheses/propose_by_matches.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "engine/common/parallel.hpp"
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
  std::vector<std::size_t> chosen;
  std::vector<std::vector<std::uint32_t>> models;  // of each
  for (std::size_t k = 0; k < (*index)->size(); ++k) {
    const LevelShape shape = (*index)->shape(k);
    if (shape.resolution < levels.finest) continue;
    std::vector<std::uint32_t> of_level;
    std::ranges::set_intersection(shape.models, models_, std::back_inserter(of_level));
    const bool is_own = std::ranges::any_of(of_level, [&](std::uint32_t m) {
      return library.shape(m).features[0].resolution == shape.resolution;
    });
    if (of_level.empty() || (levels.only_own && !is_own)) continue;
    chosen.push_back(k);
    models.push_back(std::move(of_level));
  }
  std::vector<SceneSample> samples(chosen.size());
  for_each_index(chosen.size(), [&](std::size_t k) {
    samples[k] = sample_for_models(library, scene_, (*index)->shape(chosen[k]).resolution,
                                   models[k], large_planes_);
  });
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (samples[k].points.size() == 0) continue;
    TRIVET_TRY_ASSIGN(const FeatureLevel* const level, (*index)->level(chosen[k]));
    matches_.push_back(match_features(library.basis, *level, {scene_, samples[k], explained},
                                      options, [&] { recognizer_.release_memory(); }));
    recognizer_.release_memory();
  }
  return {};
}

}  // namespace trivet::engine
