#include "engine/selection/odds.hpp"

#include <algorithm>
#include <cmath>

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

double log_odds(float probability, double least) noexcept {
  const double p = std::clamp(static_cast<double>(probability), least, 1 - least);
  return std::log(p / (1 - p));
}

double rival_log_odds(float score, float other_score,
                      const kernels::PoseComparison& comparison) noexcept {
  return kOfZ * comparison.z +
         kOfScores * (log_odds(score, kLeastOfRival) - log_odds(other_score, kLeastOfRival));
}

}  // namespace trivet::engine
