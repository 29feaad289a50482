/// Training of models and writing of libraries.
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

/// Source of one model.
struct ModelSource {
  std::string name;
  std::filesystem::path file;
  double scale = 1;                  ///< factor from the file's coordinates to the library's unit
  std::optional<Symmetry> symmetry;  ///< absent: determined by the program
  /// Whether the name was derived from the file's name. Such a model does not replace one from a
  /// file with another name.
  bool named_by_file = false;
};

/// Statistics of training a model.
struct TrainStats {
  StageTimes times;
  std::size_t num_ppf_points = 0;
  std::uint64_t num_ppf_entries = 0;
  std::size_t num_features = 0;
  std::size_t num_hidden_samples = 0;  ///< number of dropped samples inside the model
  std::vector<std::string> warnings;   ///< messages for the user
};

/// A trained model with its statistics.
struct TrainedModel {
  Model model;
  TrainStats stats;
};

/// Train one model from a mesh, or from a cloud, which receives faces if it lies on a surface. Same
/// input, same bytes for any number of threads.
///
/// basis  basis of the features; empty: the model has no features
/// Errors: bad_data (too few distinct points, no extent).
Result<TrainedModel> train_model(const Cloud& cloud, const ModelSource& source,
                                 const TrainOptions& options, const TriSpinBasis& basis = {});

/// The sampling step for a diameter: relative_step times the diameter, rounded to a quarter of an
/// octave, so that models of similar size share the scene's preparation and its point pair
/// features.
float sampling_step(float diameter, float relative_step);

/// Input and output of a training run.
struct TrainRequest {
  std::vector<ModelSource> sources;
  LengthUnit unit = LengthUnit::meter;
  TrainOptions options;
  std::filesystem::path file;
  bool prune = false;  ///< whether to remove models that are not among the sources
  /// Whether to skip models that cannot be trained; otherwise nothing is written.
  bool keep_going = false;
  std::vector<std::string> left_out =
      {};  ///< files and folders (NAME/) that are not sources, for messages
};

/// Origin of a library's model in a run.
enum class ModelOrigin : std::uint8_t {
  trained,  ///< in this run
  resumed,  ///< by an earlier, unfinished run
  kept,     ///< from the previous library: unchanged, or not among the sources
};

/// Properties of a library's model and statistics of its training.
struct ModelFacts {
  std::string name;
  ModelOrigin origin = ModelOrigin::trained;
  std::size_t num_vertices = 0, num_triangles = 0;  ///< no triangles: trained from a cloud
  float diameter = 0;                               ///< [library unit]
  std::size_t num_symmetries = 0, num_near_symmetries = 0;
  bool axis = false, near_axis = false, declared = false;  ///< kinds of its symmetries
  std::uint64_t num_ppf_entries = 0;
  std::size_t num_features = 0;
  std::uint64_t bytes = 0;            ///< size in the file, without its share of the index
  StageTimes times;                   ///< stages of training in this run
  std::vector<std::string> warnings;  ///< warnings in this run
};

/// A model that could not be trained.
struct ModelFault {
  std::string name;
  Error error;
};

/// Result of a training run.
struct TrainReport {
  std::vector<ModelFacts> models;  ///< models of the library, by name
  std::vector<ModelFault> faults;  ///< by name; only if the run skips such models
  std::size_t num_removed = 0;     ///< number of models removed from the previous library
  bool unchanged = false;          ///< whether the file did not change
  double seconds = 0;
};

/// Progress of the parts of a run. The token of `training` stops all of them.
struct TrainProgress {
  Progress reading;   ///< sources
  Progress training;  ///< models; reused ones are finished from the start
  Progress writing;   ///< models written into the library
};

/// Update a library from its sources. Models in the file with the same sources and parameters are
/// reused, the others are trained. The file has the same bytes as if all models had been trained
/// now, and is replaced as a whole at the end.
///
/// Trained models are stored beside the file (FILE.parts) until then, so that the next run
/// continues one that was stopped, killed or had no disk space. A few models are in flight at a
/// time, so memory does not grow with the library.
///
/// Errors: usage (unit or parameters differ from those of models of the file that should remain; a
/// source without an explicit name would replace the model of another file), cannot_create (another
/// process writes the file), bad_data (models that cannot be trained, all together; the file is
/// damaged), io, resumable (stopped: reports the progress). In these cases the previous file does
/// not change.
Result<TrainReport> train_library(const TrainRequest& request, const TrainProgress& progress = {});

}  // namespace trivet
