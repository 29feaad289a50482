/// Everything that a study has to compute, each item once, identified by its dependencies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/study/study.hpp"
#include "engine/training/train.hpp"

namespace trivet::apps::study {

/// A set of scenes: scanned, or those of a manifest.
struct SceneSet {
  std::string key;
  std::vector<std::size_t> models;  ///< groups with models in the scenes
  std::filesystem::path manifest;   ///< empty: scanned
  ScanOptions options{};
};

/// The inputs of a library.
struct LibraryPlan {
  std::string key;
  std::size_t set = 0;              ///< set whose models the library contains
  std::vector<std::size_t> others;  ///< sets whose first models are added
  std::uint32_t num_others = 0;     ///< number of these models
  TrainOptions options{};
};

/// One recognition of one scene.
struct Cell {
  std::string key;
  std::size_t set = 0, scene = 0, library = 0;
  DegradeOptions degrade{};
  std::uint64_t degrade_seed = 0;
  RecognizeOptions options{};
};

/// One point of an experiment: a variant of one method on one group of scenes.
struct StudyPoint {
  std::size_t experiment = 0, scenes = 0, method = 0, variant = 0;
  StudySettings settings{};
  std::vector<std::size_t> sets;   ///< one per repetition
  std::vector<std::size_t> cells;  ///< cells of the scenes of these sets, in their order
};

struct StudyPlan {
  std::vector<SceneSet> sets;
  std::vector<LibraryPlan> libraries;
  std::vector<Cell> cells;  ///< ordered by library
  std::vector<StudyPoint> points;
};

/// A key is a hash of all dependencies of an item: the settings of its stage and of the previous
/// ones, the bytes of the files, the version of the program.
/// Errors: of reading the models' files and manifests.
Result<StudyPlan> plan_study(const Study& study);

}  // namespace trivet::apps::study
