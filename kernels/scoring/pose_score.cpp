#include "kernels/scoring/pose_score.hpp"

#include <algorithm>
#include <cmath>

namespace trivet::kernels {
namespace {

constexpr float kEnoughPixels = 200;  // more of them show how near the object is, not how right the
                                      // pose is

}  // namespace

ScoreParts score_parts(const Examination& e, float relative_tolerance, float correlation) noexcept {
  const float measured = e.consistent + e.violation + e.background;
  // Nothing was measured beyond the images. Gaps of the measured surface tell nothing.
  const float silhouette = e.covered - e.gaps + e.outside;
  const float outline = e.outline_free + e.outline_touching + e.outline_crossed;
  // The offsets are the resolution of sensors near zero: without them a part would grow with the
  // number of pixels, and near objects would score better than far ones.
  constexpr ScoreOffsets offset = kScoreOffsets;
  return {std::log(e.violation / (measured + 10) + offset.violation),
          std::log(e.background / (measured + 10) + offset.background),
          e.outline_free / (e.outline + 5),
          std::log(e.outline_crossed / (outline + 5) + offset.crossed),
          std::log(e.outline_touching / (outline + 5) + offset.touching),
          std::log(e.buried / (outline + e.buried + 5) + offset.buried),
          e.residual,
          std::log(e.smooth + offset.smooth),
          std::log(e.slope + offset.slope),
          std::log(e.stability + offset.stability),
          std::log(e.consistent / (silhouette + 1) + offset.consistent),
          (e.unknown - e.gaps) / (e.covered + 1),
          std::log(std::min(e.consistent, kEnoughPixels) + offset.pixels),
          std::log(e.sunk / (measured + e.sunk + 10) + offset.sunk),
          std::log(e.relief + offset.relief),
          std::log(relative_tolerance),
          correlation};
}

float part_evidence(const ScoreModel& model, const ScoreParts& parts, std::size_t part) noexcept {
  const auto& knots = model.knots[part];
  const std::array<float, 2> shares = sensor_shares(parts);
  float sum = 0;
  for (std::size_t k = 0; k + 1 < ScoreModel::kKnots; ++k) {
    if (!(knots[k + 1] > knots[k])) continue;
    const float ramp = std::clamp((parts[part] - knots[k]) / (knots[k + 1] - knots[k]), 0.0F, 1.0F);
    const float weight =
        shares[0] * model.weights[0][part][k] + shares[1] * model.weights[1][part][k];
    sum += weight * (kScoreParts[part].favorable ? ramp : 1 - ramp);
  }
  return sum;
}

float pose_probability(const ScoreModel& model, const ScoreParts& parts) noexcept {
  const std::array<float, 2> shares = sensor_shares(parts);
  float log_odds = shares[0] * model.bias[0] + shares[1] * model.bias[1];
  for (std::size_t part = 0; part < kNumScoreParts; ++part)
    log_odds += part_evidence(model, parts, part);
  return 1 / (1 + std::exp(-log_odds));
}

double log_odds(float probability, double least) noexcept {
  const double p = std::clamp(static_cast<double>(probability), least, 1 - least);
  return std::log(p / (1 - p));
}

}  // namespace trivet::kernels
