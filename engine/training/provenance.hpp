/// Provenance of models and libraries.
#pragma once

#include <string>

#include "engine/training/train.hpp"

namespace trivet::engine {

/// Revision of training. It is raised whenever training gives different bytes for the same input,
/// so that models of an older revision are trained again.
inline constexpr int kTrainingRevision = 2;

/// XXH3-128 checksum of everything that determines a model's bytes, except its name: 32 hexadecimal
/// digits.
///
/// source_xxh3  of the file's bytes
std::string fingerprint_of(const ModelSource& source, const std::string& source_xxh3,
                           LengthUnit unit, const TrainOptions& options);

/// The header of a library trained by this program.
LibraryHeader library_header(LengthUnit unit, const TrainOptions& options);

/// All options with their values: {"methods": ["ppf", "trisi"], "relative-step": 0.04, ...}.
std::string parameters_json(const TrainOptions& options);

/// Parse the output of parameters_json. Errors: bad_data (options of another version; names them).
Result<TrainOptions> parse_parameters(const std::string& json);

}  // namespace trivet::engine
