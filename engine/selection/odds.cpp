#include "engine/selection/odds.hpp"

#include "kernels/verification/pose_score.hpp"

namespace trivet::engine {
namespace {

// Fitted to 3,035 pairs of a correct and a wrong hypothesis for one place, found in rendered scenes
// among 1,000 models: log loss 0.036, compared with 0.039 by z alone and 0.152 by scores.
constexpr double kOfZ = 1.44, kOfScores = 0.79;
constexpr double kLeastOfRival = 1e-4;

}  // namespace

float scale_odds(float probability, float factor) noexcept {
  return factor * probability / (1 - probability + factor * probability);
}

double rival_log_odds(float score, float other_score,
                      const kernels::PoseComparison& comparison) noexcept {
  return kOfZ * comparison.z + kOfScores * (kernels::log_odds(score, kLeastOfRival) -
                                            kernels::log_odds(other_score, kLeastOfRival));
}

}  // namespace trivet::engine
