#include "engine/verification/choose_rows.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "engine/common/parallel.hpp"
#include "kernels/common/pose_math.hpp"

namespace trivet::engine {
namespace {

constexpr float kPlace = 0.2F;  // [diameters]
// Where many instances of a model lie, the best visible ones must not use up the budget: each place
// gets so many first, and what is left of the budget goes to further ones of a place. Flat parts have
// many poses at a place that differ by a turn or a flip, which coarse tests do not tell apart.
constexpr std::size_t kRefinedAPlace = 8, kExaminedAPlace = 2;
constexpr std::size_t kFurther = 4;        // times as many
constexpr float kSameTranslation = 0.01F;  // [diameters]
constexpr float kSameRotationRad = 0.035F;

/// Choice of poses from the first on, with a limit per place on its part of the budget.
class Spread {
 public:
  Spread(const PoseTable& table, const ModelInfo& model) : table_(table), model_(model) {}

  /// Add rows with scores above a minimum in this order, until there are `limit` in total.
  void add(std::span<const Row> order, float least_score, std::size_t limit,
           std::size_t limit_a_place) {
    for (const Row row : order) {
      if (chosen_.size() == limit) return;
      if (!(table_.score[row] > least_score) || std::ranges::find(chosen_, row) != chosen_.end())
        continue;
      const Eigen::Vector3f center = table_.T_scene_model[row] * model_.center;
      const auto near = std::ranges::count_if(centers_, [&](const Eigen::Vector3f& other) {
        return (other - center).norm() < kPlace * model_.diameter;
      });
      if (near >= static_cast<std::ptrdiff_t>(limit_a_place)) continue;
      chosen_.push_back(row);
      centers_.push_back(center);
    }
  }
  /// As `add`: first few a place, then further ones.
  void add_deep(std::span<const Row> order, float least_score, std::size_t limit,
                std::size_t limit_a_place) {
    add(order, least_score, limit, limit_a_place);
    add(order, least_score, limit, kFurther * limit_a_place);
  }
  std::vector<Row> chosen() && { return std::move(chosen_); }

 private:
  const PoseTable& table_;
  const ModelInfo& model_;
  std::vector<Row> chosen_;
  std::vector<Eigen::Vector3f> centers_;
};

std::vector<Row> without_repetitions(PoseTable& table, std::span<const Row> rows,
                                     const ModelInfo& model) {
  std::vector<Row> kept;
  kept.reserve(rows.size());
  for (const Row row : by_falling(table.score, rows)) {
    const auto known = std::ranges::find_if(kept, [&](Row other) {
      const kernels::PoseDistance distance = kernels::pose_distance(
          table.T_scene_model[other], table.T_scene_model[row], model.symmetry, model.center);
      return distance.translation < kSameTranslation * model.diameter &&
             distance.rotation_rad < kSameRotationRad;
    });
    if (known == kept.end()) {
      kept.push_back(row);
    } else {
      table.source[*known] = std::min(table.source[*known], table.source[row]);
    }
  }
  return kept;
}

}  // namespace

std::vector<Row> choose_of_each_model(
    const PoseTable& table, std::span<const Row> rows, const Library& library,
    const std::function<std::vector<Row>(const ModelInfo&, std::span<const Row>)>& choose) {
  std::map<std::uint32_t, std::vector<Row>> by_model;
  for (const Row row : rows) by_model[table.model[row]].push_back(row);
  std::vector<std::pair<const std::uint32_t, std::vector<Row>>*> all;
  all.reserve(by_model.size());
  for (auto& of_model : by_model) all.push_back(&of_model);
  for_each_index(all.size(), [&](std::size_t k) {
    auto& [model, of_model] = *all[k];
    of_model = choose(library.models[model], of_model);
  });
  std::vector<Row> chosen;
  for (const auto& [model, of_model] : by_model)
    chosen.insert(chosen.end(), of_model.begin(), of_model.end());
  return chosen;
}

std::vector<Row> choose_to_judge(const PoseTable& table, std::span<const Row> rows,
                                 const ModelInfo& model, std::size_t max_refined) {
  constexpr std::size_t kAPlace = kContourShare * kRefinedAPlace;
  Spread first(table, model);
  first.add_deep(by_falling(table.share, rows), 0, max_refined / 2, kAPlace);
  first.add_deep(by_falling(table.score, rows), 0, kContourShare * max_refined, kAPlace);
  return std::move(first).chosen();
}

std::vector<Row> choose_to_refine(const PoseTable& table, std::span<const Row> rows,
                                  const ModelInfo& model, std::size_t max_refined) {
  Spread best(table, model);
  best.add_deep(by_falling(table.score, rows), 0, max_refined - max_refined / 2, kRefinedAPlace);
  best.add_deep(by_falling(table.share, rows), 0, max_refined, kRefinedAPlace);
  return std::move(best).chosen();
}

std::vector<Row> choose_to_examine(PoseTable& table, std::span<const Row> rows,
                                   const ModelInfo& model, std::size_t max_examined,
                                   float least_score) {
  const std::vector<Row> poses = without_repetitions(table, rows, model);
  Spread best(table, model);
  const std::vector<Row> order = by_falling(table.score, poses);
  if (model.near_axis) {
    // Turns about this axis are compared with each other (settle_alternatives). The one of many tested
    // that fits its noise best would seem surer than it is.
    best.add(order, least_score, max_examined, kExaminedAPlace);
  } else {
    best.add_deep(order, least_score, max_examined, kExaminedAPlace);
  }
  return std::move(best).chosen();
}

}  // namespace trivet::engine
