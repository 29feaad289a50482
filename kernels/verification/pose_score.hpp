/// How sure a posed model is: a probability from the parts of its examination.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "kernels/verification/examine_pose.hpp"

namespace trivet::kernels {

/// One part of a score: what it is called, and whether more of it speaks for the pose.
struct ScorePart {
  std::string_view name;
  bool favorable;
};

inline constexpr std::array<ScorePart, 17> kScoreParts{{
    {"violation", false},    // log share of the seen pixels that the sensor looked through
    {"background", false},   // ... that agree only with a background plane
    {"free", true},          // share of the outline beyond which the scene falls back
    {"crossed", false},      // log share of the judged outline beyond which the scene runs on
    {"touching", false},     // ... beyond which something else touches
    {"buried", false},       // log share of the edge of the seen part that dips beneath the scene
    {"residual", false},     // mean squared residual in squared tolerances
    {"smooth", false},       // log of the same, averaged over windows first
    {"slope", false},        // log of the mean angle between both surfaces
    {"stability", true},     // log of how well the seen surface holds the pose
    {"consistent", true},    // log share of the silhouette that agrees
    {"unknown", false},      // share of the silhouette without measurement
    {"pixels", true},        // log of the number of pixels that agree, up to 200
    {"sunk", false},         // log share of what is hidden by little
    {"relief", true},        // log of how far what is seen is from a plane, in tolerances
    {"coarseness", false},   // log of the tolerance in diameters
    {"correlation", false},  // of the scan's errors from pixel to pixel: chooses the weights
}};
inline constexpr std::size_t kNumScoreParts = kScoreParts.size();
inline constexpr std::size_t kCorrelationPart = kNumScoreParts - 1;

/// What is added to parts before their logarithms are taken: what a sensor cannot tell from nothing.
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

/// relative_tolerance  that the pose was examined with [diameters], > 0
/// correlation         of the scan's errors from pixel to pixel, 0..1
ScoreParts score_parts(const Examination& examination, float relative_tolerance,
                       float correlation) noexcept;

/// A logistic model that is additive and monotone: each part adds weights on the ramps between its
/// knots, all >= 0, so that no part can speak against what it stands for. How much a part tells
/// depends on the sensor, so there are weights for errors that are independent from pixel to pixel
/// and for errors that neighbors share; between, the log odds of both are mixed.
struct ScoreModel {
  static constexpr std::size_t kKnots = 5;
  using Weights = std::array<std::array<float, kKnots - 1>, kNumScoreParts>;  ///< of the ramps
  /// Independent, shared.
  std::array<float, 2> bias{};
  std::array<std::array<float, kKnots>, kNumScoreParts> knots{};  ///< rising
  std::array<Weights, 2> weights{};
};

/// What the bias and each of the weights [0] and [1] count for parts of this correlation.
inline std::array<float, 2> sensor_shares(const ScoreParts& parts) noexcept {
  return {1 - parts[kCorrelationPart], parts[kCorrelationPart]};
}

/// What one part adds to the log odds, 0 or more.
float part_evidence(const ScoreModel& model, const ScoreParts& parts, std::size_t part) noexcept;

/// The probability that the pose is right, 0..1.
float pose_probability(const ScoreModel& model, const ScoreParts& parts) noexcept;

}  // namespace trivet::kernels
