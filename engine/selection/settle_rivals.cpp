#include "engine/selection/settle_rivals.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "engine/common/parallel.hpp"

namespace trivet::engine {
namespace {

/// The best poses of each other model that a chosen pose hides, by model.
std::vector<Row> rivals_of(Row chosen, const TestedPoses& poses, std::span<const Refusal> refused) {
  const PoseTable& table = poses.table;
  std::map<std::uint32_t, std::vector<Row>> by_model;
  for (const Refusal& refusal : refused) {
    const std::uint32_t model = table.model[refusal.row];
    if (refusal.explained_by == chosen && model != table.model[chosen] &&
        table.score[refusal.row] >= kRivalScore * table.score[chosen])
      add_rival(poses, refusal.row, by_model[model]);
  }
  std::vector<Row> rivals;
  for (const auto& [model, rows] : by_model) rivals.insert(rivals.end(), rows.begin(), rows.end());
  return rivals;
}

/// The likelier of two poses: `rival` if the scan supports it better.
Result<Row> likelier(RivalComparisons& comparisons, const TestedPoses& poses, Row rival, Row winner,
                     kernels::CompareScratch& scratch) {
  TRIVET_TRY_ASSIGN(
      const RivalComparison comparison,
      comparisons.of(rival_of(poses.table, rival), rival_of(poses.table, winner), scratch));
  return comparison.log_odds > 0 ? rival : winner;
}

}  // namespace

void exchange(Row loser, Row winner, std::vector<Refusal>& refused) {
  for (Refusal& refusal : refused) {
    if (refusal.row == winner) {
      refusal.row = loser;
      refusal.explained_by = winner;
    } else if (refusal.explained_by == loser) {
      refusal.explained_by = winner;
    }
  }
}

Result<void> settle_rivals(RivalComparisons& comparisons, const TestedPoses& poses,
                           Selection& selection) {
  std::vector<Row> winners = selection.chosen;
  std::vector<Result<void>> results(winners.size());
  for_each_index(winners.size(), [&](std::size_t k) {
    kernels::CompareScratch scratch;
    for (const Row rival : rivals_of(selection.chosen[k], poses, selection.refused)) {
      check_stop();
      const Result<Row> winner = likelier(comparisons, poses, rival, winners[k], scratch);
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
    exchange(loser, winner, selection.refused);
  }
  return {};
}

}  // namespace trivet::engine
