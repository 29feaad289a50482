#include "engine/selection/settle_rivals.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "engine/common/parallel.hpp"
#include "engine/selection/rival_odds.hpp"
#include "kernels/verification/compare_poses.hpp"

namespace trivet::engine {
namespace {

constexpr float kRivalScore = 0.5F;  // of the score of what was taken
constexpr std::size_t kPosesOfRival = 2;

/// By its first candidate, the best ones of each other model that `taken` hides.
std::vector<std::uint32_t> rivals_of(std::uint32_t taken, std::span<const Candidate> candidates,
                                     std::span<const RejectedCandidate> refused) {
  std::vector<std::uint32_t> rivals;
  std::map<std::uint32_t, std::size_t> of_model;
  for (const RejectedCandidate& refusal : refused) {
    const Candidate& rival = candidates[refusal.candidate];
    if (refusal.explained_by != taken || rival.model == candidates[taken].model ||
        rival.score < kRivalScore * candidates[taken].score ||
        ++of_model[rival.model] > kPosesOfRival)
      continue;
    rivals.push_back(refusal.candidate);
  }
  return rivals;
}

}  // namespace

Result<void> settle_rivals(const Recognizer& recognizer, const PreparedScene& scene,
                           std::span<const Candidate> candidates, const PoseTestOptions& test,
                           Selection& selection) {
  const std::vector<Model>& models = recognizer.library().models;
  std::vector<std::uint32_t> winners(selection.chosen.size());
  std::vector<Result<void>> results(winners.size());
  for_each_index(winners.size(), [&](std::size_t k) {
    std::uint32_t winner = selection.chosen[k];
    kernels::CompareScratch scratch;
    for (const std::uint32_t rival :
         rivals_of(selection.chosen[k], candidates, selection.refused)) {
      check_stop();
      const Candidate& a = candidates[rival];
      const Candidate& b = candidates[winner];
      const auto surface = recognizer.surface(a.model);
      const auto other = recognizer.surface(b.model);
      if (!surface || !other) {
        results[k] = surface ? other.error() : surface.error();
        return;
      }
      const PoseTester tester(models[b.model], scene,
                              models[b.model].ppf.quantization.distance_step, test);
      const kernels::PoseComparison comparison = kernels::compare_poses(
          scene.images, {**surface, samples_of(models[a.model]), a.T_scene_model},
          {**other, tester.samples(), b.T_scene_model}, tester.errors_of(b.T_scene_model),
          tester.strict(b.T_scene_model), scratch);
      if (rival_log_odds(a, b, comparison) > 0) winner = rival;
    }
    winners[k] = winner;
  });
  for (const Result<void>& result : results) {
    if (!result) return result.error();
  }
  for (std::size_t k = 0; k < winners.size(); ++k) {
    const std::uint32_t loser = selection.chosen[k], winner = winners[k];
    if (winner == loser) continue;
    selection.chosen[k] = winner;
    for (RejectedCandidate& refusal : selection.refused) {
      if (refusal.candidate == winner) {
        refusal.candidate = loser;
        refusal.explained_by = winner;
      } else if (refusal.explained_by == loser) {
        refusal.explained_by = winner;
      }
    }
  }
  return {};
}

}  // namespace trivet::engine
