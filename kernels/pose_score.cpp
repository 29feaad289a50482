#include "kernels/pose_score.hpp"

#include <algorithm>
#include <cmath>

namespace trivet::kernels {
namespace {

constexpr float kEnoughPixels = 200;  // more of them say how near the object is, not how right

}  // namespace

ScoreParts score_parts(const Examination& e, float relative_tolerance) noexcept {
  // The constants keep logarithms finite and stand for what a few pixels cannot tell apart.
  const float seen = e.consistent + e.violation + e.background;
  const float outline = e.outline_free + e.outline_touching + e.outline_crossed;
  return {std::log((e.violation + e.background + 1) / (seen + 10)),
          std::log((e.outline_crossed + 1) / (outline + 5)),
          e.residual,
          std::log(e.smooth + 0.002F),
          std::log(e.slope + 0.01F),
          std::log(e.hold + 0.0003F),
          std::log(e.area + 0.01F),
          std::log(e.consistent / (e.covered + 1) + 0.02F),
          e.unknown / (e.covered + 1),
          std::log(std::min(e.consistent, kEnoughPixels) + 1),
          std::log(relative_tolerance)};
}

float part_evidence(const ScoreModel& model, const ScoreParts& parts, std::size_t part) noexcept {
  const auto& knots = model.knots[part];
  float sum = 0;
  for (std::size_t k = 0; k + 1 < ScoreModel::kKnots; ++k) {
    if (!(knots[k + 1] > knots[k])) continue;
    const float ramp = std::clamp((parts[part] - knots[k]) / (knots[k + 1] - knots[k]), 0.0F, 1.0F);
    sum += model.weights[part][k] * (kScoreParts[part].favourable ? ramp : 1 - ramp);
  }
  return sum;
}

float pose_probability(const ScoreModel& model, const ScoreParts& parts) noexcept {
  float log_odds = model.bias;
  for (std::size_t part = 0; part < kNumScoreParts; ++part)
    log_odds += part_evidence(model, parts, part);
  return 1 / (1 + std::exp(-log_odds));
}

}  // namespace trivet::kernels
