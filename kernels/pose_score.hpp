/// How sure a posed model is: a probability from the parts of its examination.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "kernels/examine_pose.hpp"

namespace trivet::kernels {

/// One part of a score: what it is called, and whether more of it speaks for the pose.
struct ScorePart {
  std::string_view name;
  bool favourable;
};

inline constexpr std::array<ScorePart, 14> kScoreParts{{
    {"violation", false},   // log share of the seen pixels that the sensor looked through
    {"background", false},  // ... that agree only with a background plane
    {"free", true},         // share of the outline beyond which the scene falls back
    {"crossed", false},     // log share of the judged outline beyond which the scene runs on
    {"touching", false},    // ... beyond which something else touches
    {"buried", false},      // log share of the edge of the seen part that dips beneath the scene
    {"residual", false},    // mean squared residual in squared tolerances
    {"smooth", false},      // log of the same, averaged over windows first
    {"slope", false},       // log of the mean angle between both surfaces
    {"hold", true},         // log of how well the seen surface holds the pose
    {"consistent", true},   // log share of the silhouette that agrees
    {"unknown", false},     // share of the silhouette without measurement
    {"pixels", true},       // log of the number of pixels that agree, up to 200
    {"coarseness", false},  // log of the tolerance in diameters
}};
inline constexpr std::size_t kNumScoreParts = kScoreParts.size();

/// The parts of one pose, in the order of kScoreParts.
using ScoreParts = std::array<float, kNumScoreParts>;

/// relative_tolerance  that the pose was examined with [diameters], > 0
ScoreParts score_parts(const Examination& examination, float relative_tolerance) noexcept;

/// A logistic model that is additive and monotone: each part adds weights on the ramps between its
/// knots, all >= 0, so that no part can speak against what it stands for.
struct ScoreModel {
  static constexpr std::size_t kKnots = 5;
  float bias = 0;
  std::array<std::array<float, kKnots>, kNumScoreParts> knots{};        ///< rising
  std::array<std::array<float, kKnots - 1>, kNumScoreParts> weights{};  ///< of the ramps between
};

/// What one part adds to the log odds, 0 or more.
float part_evidence(const ScoreModel& model, const ScoreParts& parts, std::size_t part) noexcept;

/// The probability that the pose is right, 0..1.
float pose_probability(const ScoreModel& model, const ScoreParts& parts) noexcept;

/// Fitted on rendered scenes; kernels/default_score.cpp says which.
const ScoreModel& default_score() noexcept;

}  // namespace trivet::kernels
