/// A fitted score as a small file of JSON.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "kernels/verification/pose_score.hpp"
#include "storage/common/result.hpp"

namespace trivet {

struct FittedScore {
  kernels::ScoreModel model{};
  std::string origin{};  ///< what fitted it, and to what
};

/// As JSON, in numbers of five digits: each part by its name, with its knots and both weights.
std::string score_text(const FittedScore& score);

/// Read what score_text() wrote; `name` stands for the file in messages. Errors: bad_data (names
/// the value, what was expected and what was found: no score, parts that are missing or unknown,
/// numbers that no float holds, knots that fall, weights below 0).
Result<FittedScore> parse_score(std::span<const std::byte> bytes, const std::string& name);

}  // namespace trivet
