/// What a study has to compute, each thing once, named by what it depends on.
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
  std::vector<std::size_t> models;  ///< groups that lie in the scenes
  std::filesystem::path manifest;   ///< empty: scanned
  ScanOptions options{};
};

/// What a library is trained from.
struct LibraryPlan {
  std::string key;
  std::size_t set = 0;              ///< whose models it has
  std::vector<std::size_t> others;  ///< sets, of whose models it has the first
  std::uint32_t num_others = 0;     ///< so many
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
  std::vector<std::size_t> sets;   ///< one a repetition
  std::vector<std::size_t> cells;  ///< of the scenes of these sets, in their order
};

struct StudyPlan {
  std::vector<SceneSet> sets;
  std::vector<LibraryPlan> libraries;
  std::vector<Cell> cells;  ///< those of one library together
  std::vector<StudyPoint> points;
};

/// A key is a hash of everything that the thing depends on: the settings of its stage and of those
/// before, the bytes of the files, the version of the program. Errors: of reading the models' files
/// and manifests.
Result<StudyPlan> plan_study(const Study& study);

}  // namespace trivet::apps::study
