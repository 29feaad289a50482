/// Compute what a study has planned and its folder does not hold yet.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "apps/study/plan.hpp"
#include "apps/study/study.hpp"
#include "engine/evaluation/evaluate.hpp"
#include "engine/evaluation/recognize_cells.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet::apps::study {

/// Where a study keeps what it has computed: FOLDER/scenes/KEY/manifest.json, libraries/KEY.h5 and
/// cells/KEY.json, each whole or not there.
class StudyFolder {
 public:
  explicit StudyFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path scenes(const SceneSet& set) const { return folder_ / "scenes" / set.key; }
  std::filesystem::path manifest(const SceneSet& set) const {
    return set.manifest.empty() ? scenes(set) / "manifest.json" : set.manifest;
  }
  std::filesystem::path library(const LibraryPlan& library) const {
    return folder_ / "libraries" / (library.key + ".h5");
  }
  std::filesystem::path cell(const Cell& cell) const {
    return folder_ / "cells" / (cell.key + ".json");
  }

 private:
  std::filesystem::path folder_;
};

/// Tells what a run does: a Progress for each of its steps, by its verb.
using ProgressOf = std::function<Progress(std::string_view verb)>;

/// Has items worked on, each of them once, by calling `work` with all of them, or with some of them
/// again and again in each of several processes; returns when all are done. The items of the first
/// process count: others may see meanwhile what it has done.
using Share = std::function<Result<void>(
    std::span<const std::size_t> items,
    const std::function<Result<void>(std::span<const std::size_t>)>& work)>;
/// All by this process.
Result<void> do_all(std::span<const std::size_t> items,
                    const std::function<Result<void>(std::span<const std::size_t>)>& work);

/// Render, train and recognize what is missing. Stopped or killed at any time, the next run goes on
/// with what is not there yet. Errors: of each step; resumable when stopped.
Result<void> run_study(const Study& study, const StudyPlan& plan, const StudyFolder& folder,
                       const ProgressOf& progress, const Share& share = do_all);

/// The truth of each set. Errors: of reading.
Result<std::vector<Manifest>> read_sets(const StudyPlan& plan, const StudyFolder& folder);

/// What was found in the scenes of a point, in their order. Errors: of reading.
Result<std::vector<std::optional<SceneResult>>> read_cells(const StudyPlan& plan,
                                                           const StudyFolder& folder,
                                                           const std::vector<Manifest>& sets,
                                                           const StudyPoint& point);

/// What the library of a cell took by its end. Errors: of reading.
Result<LibraryUse> read_use(const StudyFolder& folder, const Cell& cell);

}  // namespace trivet::apps::study
