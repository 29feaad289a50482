#include "engine/poses/pose_table.hpp"

#include <algorithm>
#include <utility>

namespace trivet::engine {

Row PoseTable::add(std::uint32_t of_model, Source proposed_by, const Pose& pose, float num_votes,
                   float vote_share) {
  const auto row = static_cast<Row>(size());
  model.push_back(of_model);
  source.push_back(proposed_by);
  T_proposed.push_back(pose);
  T_scene_model.push_back(T_proposed.back());  // the pose may be one of T_proposed, which has moved
  votes.push_back(num_votes);
  share.push_back(vote_share);
  evidence.emplace_back();
  screen_score.push_back(0);
  score.push_back(0);
  stage.push_back(PoseStage::proposed);
  fate.push_back(PoseFate::open);
  explained_by.emplace_back();
  explained_share.push_back(0);
  test_index.push_back(0);
  return row;
}

void PoseTable::set_tested(Row row, TestedPose tested) {
  if (stage[row] != PoseStage::examined) {
    test_index[row] = static_cast<std::uint32_t>(tests.size());
    tests.emplace_back();
    ambiguities.emplace_back();
  }
  stage[row] = PoseStage::examined;
  T_scene_model[row] = tested.T_scene_model;
  score[row] = tested.score;
  tests[test_index[row]] = std::move(tested.test);
}

void PoseTable::set_settled(Row row, SettledPose settled) {
  set_tested(row, std::move(settled.pose));
  ambiguities[test_index[row]] = std::move(settled.ambiguity);
}

std::vector<Row> by_falling(std::span<const float> column, std::span<const Row> rows) {
  std::vector<Row> order(rows.begin(), rows.end());
  std::ranges::stable_sort(order, [&](Row a, Row b) { return column[a] > column[b]; });
  return order;
}

std::vector<Row> extract_best(std::span<const float> column, std::size_t limit,
                              std::vector<Row>& rows) {
  if (rows.size() <= limit) return std::exchange(rows, {});
  std::vector<Row> best = by_falling(column, rows);
  best.resize(limit);
  std::ranges::sort(best);
  const auto rest = std::stable_partition(
      rows.begin(), rows.end(), [&](Row row) { return std::ranges::binary_search(best, row); });
  std::vector<Row> extracted(rows.begin(), rest);
  rows.erase(rows.begin(), rest);
  return extracted;
}

}  // namespace trivet::engine
