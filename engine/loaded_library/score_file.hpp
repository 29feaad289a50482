/// A fitted score as a small JSON file.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "kernels/scoring/pose_score.hpp"
#include "storage/common/result.hpp"

namespace trivet {

struct FittedScore {
  kernels::ScoreModel model{};
  std::string origin{};  ///< program that fitted it, and the data
};

/// The score as JSON with numbers of five digits: each part by name, with its knots and both
/// weights.
std::string score_text(const FittedScore& score);

/// Parse the output of score_text(); `name` denotes the file in messages. Errors: bad_data (names
/// the value, what was expected and what was found: no score, missing or unknown parts, numbers
/// beyond the range of float, decreasing knots, weights below 0).
Result<FittedScore> parse_score(std::span<const std::byte> bytes, const std::string& name);

}  // namespace trivet
