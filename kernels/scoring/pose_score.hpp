/// Confidence of a posed model: a probability from the parts of its examination.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "kernels/verification/examine_pose.hpp"

namespace trivet::kernels {

/// One part of a score: its name, and whether larger values are evidence for the pose.
struct ScorePart {
  std::string_view name;
  bool favorable;
};

inline constexpr std::array<ScorePart, 17> kScoreParts{{
    {"violation", false},   // log share of the seen pixels that the sensor saw through
    {"background", false},  // log share of the seen pixels that agree only with a background plane
    {"free", true},         // share of the outline beyond which the scene falls back
    {"crossed", false},     // log share of the judged outline over which the scene continues
    {"touching", false},    // log share of the judged outline with something else in contact
    {"buried", false},      // log share of the edge of the visible part that dips beneath the scene
    {"residual", false},    // mean squared residual in squared tolerances
    {"smooth", false},      // log of the mean squared residual averaged over windows
    {"slope", false},       // log of the mean angle between both surfaces
    {"stability", true},    // log of how well the visible surface determines the pose
    {"consistent", true},   // log share of the silhouette that agrees, gaps left out
    {"unknown", false},     // share of the silhouette without measurement, but for gaps
    {"pixels", true},       // log of the number of pixels that agree, up to 200
    {"sunk", false},        // log share of slightly hidden pixels
    {"relief", true},       // log deviation of the visible surface from a plane, in tolerances
    {"coarseness", false},  // log of the tolerance in diameters
    {"correlation", false},  // correlation of the scan's errors between pixels: selects the weights
}};
inline constexpr std::size_t kNumScoreParts = kScoreParts.size();
inline constexpr std::size_t kCorrelationPart = kNumScoreParts - 1;

/// Offsets added to parts before taking logarithms: the resolution of sensors near zero.
struct ScoreOffsets {
  float violation = 0.03F, background = 0.05F, sunk = 0.03F, consistent = 0.02F;  ///< shares
  float crossed = 0.05F, touching = 0.05F, buried = 0.05F;  ///< shares of outlines
  float smooth = 0.005F;                                    ///< [squared tolerances]
  float slope = 0.02F;                                      ///< [rad]
  float stability = 0.0003F;
  float relief = 0.3F;  ///< [tolerances]
  float pixels = 1;
};
inline constexpr ScoreOffsets kScoreOffsets{};

/// The parts of one pose, in the order of kScoreParts.
using ScoreParts = std::array<float, kNumScoreParts>;

/// relative_tolerance  tolerance of the examination [diameters], > 0
/// correlation         correlation of the scan's errors from pixel to pixel, 0..1
ScoreParts score_parts(const Examination& examination, float relative_tolerance,
                       float correlation) noexcept;

/// A logistic model that is additive and monotone: each part adds weights on the ramps between its
/// knots, all >= 0, so that no part can count in the wrong direction. The evidence of a part
/// depends on the sensor, so there are weights for errors that are independent from pixel to pixel
/// and for errors that neighbors share. Between these cases, the log odds of both are interpolated.
struct ScoreModel {
  static constexpr std::size_t kKnots = 5;
  using Weights = std::array<std::array<float, kKnots - 1>, kNumScoreParts>;  ///< ramp weights
  /// Biases for independent and for shared errors.
  std::array<float, 2> bias{};
  std::array<std::array<float, kKnots>, kNumScoreParts> knots{};  ///< ascending knots
  std::array<Weights, 2> weights{};
};

/// Mixing shares of the bias and the weights [0] and [1] for the correlation of these parts.
inline std::array<float, 2> sensor_shares(const ScoreParts& parts) noexcept {
  return {1 - parts[kCorrelationPart], parts[kCorrelationPart]};
}

/// Contribution of one part to the log odds, 0 or more.
float part_evidence(const ScoreModel& model, const ScoreParts& parts, std::size_t part) noexcept;

/// The probability that the pose is right, 0..1.
float pose_probability(const ScoreModel& model, const ScoreParts& parts) noexcept;

/// Log odds of a probability clamped to [least, 1 - least].
double log_odds(float probability, double least) noexcept;

}  // namespace trivet::kernels
