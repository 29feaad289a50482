#include "engine/selection/settle_rivals.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "engine/common/parallel.hpp"
#include "engine/selection/odds.hpp"
#include "kernels/verification/compare_poses.hpp"

namespace trivet::engine {
namespace {

constexpr float kRivalScore = 0.5F;  // share of the chosen pose's score
constexpr std::size_t kPosesOfRival = 2;

/// The best poses of each other model that a chosen pose hides.
std::vector<Row> rivals_of(Row chosen, const PoseTable& table, std::span<const Refusal> refused) {
  std::vector<Row> rivals;
  std::map<std::uint32_t, std::size_t> of_model;
  for (const Refusal& refusal : refused) {
    const std::uint32_t model = table.model[refusal.row];
    if (refusal.explained_by != chosen || model == table.model[chosen] ||
        table.score[refusal.row] < kRivalScore * table.score[chosen] ||
        ++of_model[model] > kPosesOfRival)
      continue;
    rivals.push_back(refusal.row);
  }
  return rivals;
}

/// The likelier of two poses: `rival` if the scan supports it better.
Result<Row> likelier(const Recognizer& recognizer, const TestedPoses& poses,
                     const PoseTestOptions& test, Row rival, Row winner,
                     kernels::CompareScratch& scratch) {
  const PoseTable& table = poses.table;
  const std::uint32_t a = table.model[rival], b = table.model[winner];
  const auto surface = recognizer.surface(a), other = recognizer.surface(b);
  if (!surface || !other) return surface ? other.error() : surface.error();
  const Pose& pose = table.T_scene_model[winner];
  TRIVET_TRY_ASSIGN(const TestedModel rivaling, tested_model(poses.library, a));
  TRIVET_TRY_ASSIGN(const TestedModel winning, tested_model(poses.library, b));
  const PoseTester tester(winning, poses.scene, test);
  const kernels::PoseComparison comparison = kernels::compare_poses(
      poses.scene.images, {**surface, rivaling.samples, table.T_scene_model[rival]},
      {**other, tester.samples(), pose}, tester.errors_of(pose), tester.strict(pose), scratch);
  return rival_log_odds(table.score[rival], table.score[winner], comparison) > 0 ? rival : winner;
}

}  // namespace

Result<void> settle_rivals(const Recognizer& recognizer, const TestedPoses& poses,
                           const PoseTestOptions& test, Selection& selection) {
  std::vector<Row> winners = selection.chosen;
  std::vector<Result<void>> results(winners.size());
  for_each_index(winners.size(), [&](std::size_t k) {
    kernels::CompareScratch scratch;
    for (const Row rival : rivals_of(selection.chosen[k], poses.table, selection.refused)) {
      check_stop();
      const Result<Row> winner = likelier(recognizer, poses, test, rival, winners[k], scratch);
      if (!winner) {
        results[k] = winner.error();
        return;
      }
      winners[k] = *winner;
    }
  });
  for (const Result<void>& result : results) {
    if (!result) return result.error();
  }
  for (std::size_t k = 0; k < winners.size(); ++k) {
    const Row loser = selection.chosen[k], winner = winners[k];
    if (winner == loser) continue;
    selection.chosen[k] = winner;
    for (Refusal& refusal : selection.refused) {
      if (refusal.row == winner) {
        refusal.row = loser;
        refusal.explained_by = winner;
      } else if (refusal.explained_by == loser) {
        refusal.explained_by = winner;
      }
    }
  }
  return {};
}

}  // namespace trivet::engine
