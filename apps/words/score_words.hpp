/// The parts of a score in words.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "kernels/verification/pose_score.hpp"

namespace trivet::apps {

/// A score as all pages write it, "0.984": of a probability no digit is made up, so that none is 0
/// or 1.
std::string score_text(float score);

/// Two or three words for a column, and what is measured.
struct PartWords {
  std::string_view label, meaning;
};
PartWords words_of(std::size_t part);

/// What this value of a part says of the pose, as "the scene runs on beyond 40 % of its outline".
std::string finding_of(std::size_t part, float value);

/// The most that each part can add to the log odds of a pose in a scan whose errors correlate like
/// this from pixel to pixel, 0..1; 0 where the model does not weigh it.
std::array<float, kernels::kNumScoreParts> most_evidence(const kernels::ScoreModel& model,
                                                         float correlation);

/// What costs a pose most: the findings of the one or two parts that lack most of their evidence.
/// Empty where no part lacks enough to be worth a word.
std::string costliest_findings(const kernels::ScoreModel& model, const kernels::ScoreParts& parts);

/// What other answers take off the log odds of this score; 0 where there is nothing to take off.
/// With the model's bias and the evidence of all parts it makes the log odds of the score.
float deduction(const kernels::ScoreModel& model, const kernels::ScoreParts& parts, float score);

/// What the evidence alone makes of a score that other answers lower: "0.960 but for other answers".
/// Empty where they hardly do.
std::string lowered_from(const kernels::ScoreModel& model, const kernels::ScoreParts& parts,
                         float score);

}  // namespace trivet::apps
