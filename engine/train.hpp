/// Train models and write them into a library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/progress.hpp"
#include "engine/train_options.hpp"
#include "storage/cloud.hpp"
#include "storage/library.hpp"
#include "storage/model.hpp"
#include "storage/result.hpp"
#include "storage/tri_spin_features.hpp"

namespace trivet {

/// What to train: one model.
struct ModelSource {
  std::string name;
  std::filesystem::path file;
  double scale = 1;  ///< multiplies the file's coordinates, giving the library's unit
  std::optional<Symmetry> symmetry;  ///< absent: found by the program
};

struct TrainStats {
  StageTimes times;
  std::size_t num_ppf_points = 0;
  std::uint64_t num_ppf_entries = 0;
  std::size_t num_features = 0;
  std::size_t num_hidden_samples = 0;  ///< samples inside the model, dropped
  std::vector<std::string> warnings;   ///< as a person should read them
};

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

/// Find what the features of a library have in common, from some of the features of some of its
/// models: at most sixteen, spread over the list; of none once it is stopped. Errors: of reading
/// and training.
Result<TriSpinBasis> find_basis(std::span<const ModelSource> sources, LengthUnit unit,
                                const TrainOptions& options, const std::stop_token& stop = {});

/// The sampling step for a diameter: relative_step times the diameter, rounded to a quarter of an
/// octave, so that models of like size share the scene's preparation and its pair features.
float sampling_step(float diameter, float relative_step);

struct LibraryStats {
  std::vector<std::pair<std::string, TrainStats>> models;  ///< in the order of the file
  double seconds = 0;
};

/// Read, train and write all sources; models appear in the file by name. The file is replaced as a
/// whole at the end. A few models are in flight at a time, so memory does not grow with the
/// library. Errors: of reading and training, all models' together; of writing; resumable when stopped.
/// The old file then stays as it was.
Result<LibraryStats> train_library(std::span<const ModelSource> sources, LengthUnit unit,
                                   const TrainOptions& options, const std::filesystem::path& file,
                                   const Progress& progress);

}  // namespace trivet
