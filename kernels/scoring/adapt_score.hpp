/// Adaptation of a score to scans of one kind, from a few poses with known correctness.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "kernels/scoring/pose_score.hpp"

namespace trivet::kernels {

/// Changes of an adapted score. The cost of a part is the difference between the most evidence that
/// it can give and the evidence that it gives. An adaptation reweights these costs and shifts all
/// log odds. A pose without costs keeps its score up to the shift.
struct ScoreAdaptation {
  float shift = 0;                             ///< shift of the log odds
  std::array<float, kNumScoreParts> weights =  ///< weights of the costs, 0..kMaxCostWeight; 1:
                                               ///< unchanged
      [] {
        std::array<float, kNumScoreParts> ones{};
        ones.fill(1);
        return ones;
      }();
  bool operator==(const ScoreAdaptation&) const = default;
};

inline constexpr float kMaxCostWeight = 3;

/// Largest increase of the log odds of any pose by an adaptation from marked poses: the odds grow
/// at most tenfold, whatever was marked. Poses below 0.09 stay below 0.5, and those below 0.28 stay
/// below 0.8.
inline constexpr float kMaxRaise = 2.3025851F;

/// Largest contribution of a part to the log odds for independent errors [0] and shared errors [1].
std::array<float, 2> most_evidence(const ScoreModel& model, std::size_t part) noexcept;

/// The adapted score model. As additive and as monotone as the original.
ScoreModel adapted_score(const ScoreModel& model, const ScoreAdaptation& adaptation) noexcept;

/// Upper bound, over all possible poses, of the increase of the log odds by an adaptation; not
/// negative.
float largest_raise(const ScoreModel& model, const ScoreAdaptation& adaptation) noexcept;

/// Interpolation between no adaptation (share 0) and this one (share 1).
ScoreAdaptation part_of_the_way(const ScoreAdaptation& adaptation, float share) noexcept;

/// Fit an adaptation: the most probable one under a Gaussian prior centered at no adaptation, with
/// a standard deviation of 0.5 for the shift and 0.7 for each weight, among those that raise no
/// pose by more than kMaxRaise. Without rows there is no change.
///
/// parts  n, all finite
/// right  n; 1 if the pose is right, else 0
/// The same bits for any order of the rows. Source: Zhang and Oles, Information Retrieval 2001
/// (coordinate descent with trust regions, under a Gaussian prior).
ScoreAdaptation fit_adaptation(const ScoreModel& model, std::span<const ScoreParts> parts,
                               std::span<const std::uint8_t> right);

}  // namespace trivet::kernels
