#include "engine/selection/rival_odds.hpp"

#include <algorithm>
#include <cmath>

namespace trivet::engine {
namespace {

// By 3,035 pairs of a right and a wrong answer of one place, found in rendered scenes among 1,000
// models: log loss 0.036; 0.039 by z alone, 0.152 by scores.
constexpr double kOfZ = 1.44, kOfScores = 0.79;

double log_odds(float score) {
  const double p = std::clamp(static_cast<double>(score), 1e-4, 1 - 1e-4);
  return std::log(p / (1 - p));
}

}  // namespace

double rival_log_odds(const Candidate& candidate, const Candidate& other,
                      const kernels::PoseComparison& comparison) noexcept {
  return kOfZ * comparison.z + kOfScores * (log_odds(candidate.score) - log_odds(other.score));
}

}  // namespace trivet::engine
