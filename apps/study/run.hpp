/// Computes the items that a study has planned and that its folder does not contain yet.
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

/// The folder with the computed items of a study: FOLDER/scenes/KEY/manifest.json, libraries/KEY.h5
/// and cells/KEY.json. Each is complete or absent.
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

/// Creates a Progress for each step of a run, from its verb.
using ProgressOf = std::function<Progress(std::string_view verb)>;

/// Distributes items so that each is processed once. Calls `work` with all of them, or repeatedly
/// with some of them in each of several processes; returns when all are done. The items passed by
/// the first process apply, since other processes may already see its results.
using Share = std::function<Result<void>(
    std::span<const std::size_t> items,
    const std::function<Result<void>(std::span<const std::size_t>)>& work)>;
/// Processes all items in this process.
Result<void> do_all(std::span<const std::size_t> items,
                    const std::function<Result<void>(std::span<const std::size_t>)>& work);

/// Renders, trains and recognizes what is missing. After a stop or a crash, the next run continues
/// with the items that are still missing.
/// Errors: of each step; resumable when stopped.
Result<void> run_study(const Study& study, const StudyPlan& plan, const StudyFolder& folder,
                       const ProgressOf& progress, const Share& share = do_all);

/// Reads the truth of each set. Errors: of reading.
Result<std::vector<Manifest>> read_sets(const StudyPlan& plan, const StudyFolder& folder);

/// Reads the results for the scenes of a point, in their order. Errors: of reading.
Result<std::vector<std::optional<SceneResult>>> read_cells(const StudyPlan& plan,
                                                           const StudyFolder& folder,
                                                           const std::vector<Manifest>& sets,
                                                           const StudyPoint& point);

/// Reads the resources that the library of a cell had used at its end. Errors: of reading.
Result<LibraryUse> read_use(const StudyFolder& folder, const Cell& cell);

}  // namespace trivet::apps::study
