/// Train models and write them into a library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/common/progress.hpp"
#include "engine/options/train_options.hpp"
#include "engine/results/stage_times.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"
#include "storage/data/tri_spin_features.hpp"
#include "storage/library/library.hpp"

namespace trivet {

/// What to train: one model.
struct ModelSource {
  std::string name;
  std::filesystem::path file;
  double scale = 1;  ///< multiplies the file's coordinates, giving the library's unit
  std::optional<Symmetry> symmetry;  ///< absent: found by the program
  /// Nobody gave the name: it was made of the file's. It replaces no model of another file's name.
  bool named_by_file = false;
};

/// What training a model took, and gave.
struct TrainStats {
  StageTimes times;
  std::size_t num_ppf_points = 0;
  std::uint64_t num_ppf_entries = 0;
  std::size_t num_features = 0;
  std::size_t num_hidden_samples = 0;  ///< samples inside the model, dropped
  std::vector<std::string> warnings;   ///< as a person should read them
};

/// A model, and how it was trained.
struct TrainedModel {
  Model model;
  TrainStats stats;
};

/// Train one model from a mesh, or from a cloud, which gets faces if it lies on a surface. Same
/// input, same bytes for any number of threads.
///
/// basis  of the features; empty: the model gets none
/// Errors: bad_data (too few distinct points, no extent).
Result<TrainedModel> train_model(const Cloud& cloud, const ModelSource& source,
                                 const TrainOptions& options, const TriSpinBasis& basis = {});

/// The sampling step for a diameter: relative_step times the diameter, rounded to a quarter of an
/// octave, so that models of like size share the scene's preparation and its pair features.
float sampling_step(float diameter, float relative_step);

/// What to train, and into which library.
struct TrainRequest {
  std::vector<ModelSource> sources;
  LengthUnit unit = LengthUnit::meter;
  TrainOptions options;
  std::filesystem::path file;
  bool prune = false;       ///< models of the file that are not among the sources go
  bool keep_going = false;  ///< models that cannot be trained are left out; else nothing is written
  std::vector<std::string> left_out =
      {};  ///< files and folders (NAME/) that are no sources, to tell
};

/// Where a model of a library came from in a run.
enum class ModelOrigin : std::uint8_t {
  trained,  ///< now
  resumed,  ///< by a run that did not come to its end
  kept,     ///< from the library as it was: unchanged, or not among the sources
};

/// What a model of the library is, and what training it took.
struct ModelFacts {
  std::string name;
  ModelOrigin origin = ModelOrigin::trained;
  std::size_t num_vertices = 0, num_triangles = 0;  ///< no triangles: trained from a cloud
  float diameter = 0;                               ///< [library unit]
  std::size_t num_symmetries = 0, num_near_symmetries = 0;
  bool axis = false, near_axis = false, declared = false;  ///< of its symmetries
  std::uint64_t num_ppf_entries = 0;
  std::size_t num_features = 0;
  std::uint64_t bytes = 0;            ///< in the file, without its share of the index
  StageTimes times;                   ///< of training now
  std::vector<std::string> warnings;  ///< likewise
};

/// A model that cannot be trained.
struct ModelFault {
  std::string name;
  Error error;
};

/// What a run of training came to.
struct TrainReport {
  std::vector<ModelFacts> models;  ///< of the library, by name
  std::vector<ModelFault> faults;  ///< by name; only where the run was to keep going
  std::size_t num_removed = 0;     ///< models of the library as it was
  bool unchanged = false;          ///< the file was left as it is
  double seconds = 0;
};

/// How far each part of the work is; all are stopped by the token of `training`.
struct TrainProgress {
  Progress reading;   ///< of the sources
  Progress training;  ///< models; those that are taken over are done from the start
  Progress writing;   ///< models, into the library
};

/// Bring a library up to date with its sources: models whose sources and parameters are those of a
/// model of the file are taken over, the others trained. The file has the same bytes as if all had
/// been trained anew, and is replaced as a whole at the end.
///
/// What is trained is kept beside the file (FILE.parts) until then: a run that was stopped, killed
/// or found the disk full is gone on with by the next one. A few models are in flight at a time, so
/// memory does not grow with the library.
///
/// Errors: usage (unit or parameters are not those of models of the file that were to stay; a source
/// that nobody named would replace the model of another file),
/// cannot_create (another process writes the file), bad_data (of models that cannot be trained,
/// all together; the file is damaged), io, resumable (stopped: says how far it came). The old file
/// then stays as it was.
Result<TrainReport> train_library(const TrainRequest& request, const TrainProgress& progress = {});

}  // namespace trivet
