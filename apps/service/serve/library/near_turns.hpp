/// Near symmetries of a model, rotation by rotation, with the deviation that each causes.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps::service {

/// Path segment of a model or part.
inline constexpr std::string_view kNearSymmetry = "near-symmetry";

/// {"turns": [{"motions", "axis", "measured", "deviation": {"median", "p90", "largest"},
/// "place"}]}. Each rotation is listed with its inverse and both after each symmetry. A rotation by
/// any angle about the near axis has no motions; its worst angle is measured. Lengths are in the
/// library's unit.
/// Errors: damaged.
Result<nlohmann::ordered_json> near_turns_json(const Library& library, std::uint32_t model);

}  // namespace trivet::apps::service
