/// Which poses of a model go on to the next stage of verification.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/poses/pose_table.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Contours judged per pose that is refined.
inline constexpr std::size_t kContourShare = 3;

/// Choose among the rows of each model: choose(model, rows). Returns what it chooses, by model.
std::vector<Row> choose_of_each_model(
    const PoseTable& table, std::span<const Row> rows, const Library& library,
    const std::function<std::vector<Row>(const Model&, std::span<const Row>)>& choose);

/// Of one model's screened poses, those whose contours are judged: that only lowers a score, and
/// costs more.
std::vector<Row> choose_to_judge(const PoseTable& table, std::span<const Row> rows,
                                 const Model& model, std::size_t max_refined);

/// Of one model's poses, those to refine: half by what is seen, half by votes, since what lies
/// end-on or deep looks worse than it is.
std::vector<Row> choose_to_refine(const PoseTable& table, std::span<const Row> rows,
                                  const Model& model, std::size_t max_refined);

/// Of one model's refined poses above a score, those to test by rays. Of poses that refinement led
/// to one place it leaves the best, which gets the first of their sources.
std::vector<Row> choose_to_examine(PoseTable& table, std::span<const Row> rows, const Model& model,
                                   std::size_t max_examined, float least_score);

}  // namespace trivet::engine
