/// Choice of the poses of a model that go on to the next stage of verification.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/poses/pose_table.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Number of contours judged per refined pose.
inline constexpr std::size_t kContourShare = 3;

/// Apply choose(model, rows) to the rows of each model. Returns the chosen rows, by model.
std::vector<Row> choose_of_each_model(
    const PoseTable& table, std::span<const Row> rows, const Library& library,
    const std::function<std::vector<Row>(const ModelInfo&, std::span<const Row>)>& choose);

/// Choose the screened poses of one model whose contours are judged. Not all are, because judging
/// is expensive and only lowers scores.
std::vector<Row> choose_to_judge(const PoseTable& table, std::span<const Row> rows,
                                 const ModelInfo& model, std::size_t max_refined);

/// Choose the poses of one model to refine. Half are chosen by visible surface and half by votes,
/// since objects seen end-on or lying deep score lower than they should.
std::vector<Row> choose_to_refine(const PoseTable& table, std::span<const Row> rows,
                                  const ModelInfo& model, std::size_t max_refined);

/// Choose the refined poses of one model, with scores above a minimum, to test by rays. Of poses
/// that converged to one place only the best remains, with the first of their sources.
std::vector<Row> choose_to_examine(PoseTable& table, std::span<const Row> rows,
                                   const ModelInfo& model, std::size_t max_examined,
                                   float least_score);

}  // namespace trivet::engine
