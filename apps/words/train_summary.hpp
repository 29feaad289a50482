/// The result of a training, as text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "engine/training/train.hpp"

namespace trivet::apps {

/// A row for each model that is new to the library, limited to a screen or two; empty: none.
std::string train_table(const TrainReport& report, LengthUnit unit);

/// A summary in the form "LIB.h5: 1000 models (3 trained, 997 as they were), ... point pairs, ...
/// features, 4.2 s".
std::string train_line(const TrainReport& report, const std::string& library);

/// {"library", "unit", "seconds", "unchanged", "removed", "models": [{"name", "origin", "kind",
/// "vertices", "triangles", "diameter", "symmetry", "near_symmetry", "point_pairs", "features",
/// "bytes", "seconds", "stages", "warnings"}], "faults": [{"name", "reason"}],
/// "left_out": ["parts/clip.3mf", "parts/sub/"]}
nlohmann::ordered_json train_json(const TrainReport& report, const TrainRequest& request);

}  // namespace trivet::apps
