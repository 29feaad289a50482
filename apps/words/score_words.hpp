/// The parts of a score in words.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "kernels/scoring/pose_score.hpp"

namespace trivet::apps {

/// A score in the form of all pages, "0.984". It has no invented digits of a probability, so that
/// it is never 0 or 1.
std::string score_text(float score);

/// Two or three words for a column, and the measured quantity.
struct PartWords {
  std::string_view label, meaning;
};
PartWords words_of(std::size_t part);

/// What the log odds of a score are made of beside its parts, and their sum.
struct ScoreRows {
  PartWords begin, others, sum;
};
inline constexpr ScoreRows kScoreRows{
    {"begins at", "what is believed before anything is seen"},
    {"other answers", "alternatives, look-alikes or doubtful answers beside it take this off"},
    {"log odds", "the sum; as a probability it is the score"}};

/// The finding that this value of a part stands for, such as "the scene runs on beyond 40 % of its
/// outline".
std::string finding_of(std::size_t part, float value);

/// The most that each part can add to the log odds of a pose, in a scan whose errors have this
/// correlation between pixels, 0..1; 0 if the model gives it no weight.
std::array<float, kernels::kNumScoreParts> most_evidence(const kernels::ScoreModel& model,
                                                         float correlation);

/// The findings of the one or two parts that lack most of their evidence. Empty if no part lacks
/// enough to be mentioned.
std::string costliest_findings(const kernels::ScoreModel& model, const kernels::ScoreParts& parts);

/// The reduction of the log odds of this score by other answers; 0 if there is none. With the
/// model's bias and the evidence of all parts it adds up to the log odds of the score.
float deduction(const kernels::ScoreModel& model, const kernels::ScoreParts& parts, float score);

/// The score from the evidence alone, if other answers lower it: "0.960 but for other answers".
/// Empty if they hardly do.
std::string lowered_from(const kernels::ScoreModel& model, const kernels::ScoreParts& parts,
                         float score);

}  // namespace trivet::apps
