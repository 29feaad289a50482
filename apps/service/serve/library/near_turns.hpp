/// By what a model nearly looks the same, turn by turn, and how far each takes it off itself.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps::service {

/// Of a model or part, in paths.
inline constexpr std::string_view kNearSymmetry = "near-symmetry";

/// {"turns": [{"motions", "axis", "measured", "deviation": {"median", "p90", "largest"}, "place"}]}:
/// each with its inverse and both after each symmetry, and any turn about the near axis as one without
/// motions, of which the worst is measured. Lengths are in the library's unit. Errors: bad_data (the model is damaged).
Result<nlohmann::ordered_json> near_turns_json(const Library& library, std::uint32_t model);

}  // namespace trivet::apps::service
