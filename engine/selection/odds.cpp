#include "engine/selection/odds.hpp"

#include <cmath>

#include "kernels/scoring/pose_score.hpp"

namespace trivet::engine {
namespace {

// Fitted to 3,035 pairs of a correct and a wrong hypothesis for one place, found in rendered scenes
// among 1,000 models: log loss 0.036, compared with 0.039 by z alone and 0.152 by scores.
constexpr double kOfZ = 1.44, kOfScores = 0.79;
constexpr double kLeastOfRival = 1e-4;
// On 25 sets of real scans, 279 objects of 305 are found with 12 false (the mean of four samplings).
// They are 274 with 12 if any strange answer, however unlikely, takes 0.4 of the odds.
constexpr float kOddsBesideStrange = 0.1F;

}  // namespace

float scale_odds(float probability, float factor) noexcept {
  return factor * probability / (1 - probability + factor * probability);
}

float score_beside_strange(float score, float share) noexcept {
  return scale_odds(score, std::lerp(1.0F, kOddsBesideStrange, share));
}

double rival_log_odds(float score, float other_score,
                      const kernels::PoseComparison& comparison) noexcept {
  return kOfZ * comparison.z + kOfScores * (kernels::log_odds(score, kLeastOfRival) -
                                            kernels::log_odds(other_score, kLeastOfRival));
}

}  // namespace trivet::engine
