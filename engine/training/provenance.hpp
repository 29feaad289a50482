/// What models and libraries are trained from.
#pragma once

#include <string>

#include "engine/training/train.hpp"

namespace trivet::engine {

/// Raised whenever training gives other bytes than before for the same input: models of an older
/// revision are then trained anew.
inline constexpr int kTrainingRevision = 2;

/// XXH3-128 of all that a model's bytes come from, but for its name: 32 hexadecimal digits.
///
/// source_xxh3  of the file's bytes
std::string fingerprint_of(const ModelSource& source, const std::string& source_xxh3,
                           LengthUnit unit, const TrainOptions& options);

/// The header of a library that this program trains.
LibraryHeader library_header(LengthUnit unit, const TrainOptions& options);

/// All options, whatever their values: {"methods": ["ppf", "trisi"], "relative-step": 0.04, ...}.
std::string parameters_json(const TrainOptions& options);

/// The options that say so. Errors: bad_data (not those of this version: says which).
Result<TrainOptions> parse_parameters(const std::string& json);

}  // namespace trivet::engine
