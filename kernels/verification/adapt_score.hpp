/// Adapt a score to scans of one kind, from a few poses of which it is known whether they are
/// right.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "kernels/verification/pose_score.hpp"

namespace trivet::kernels {

/// What an adapted score does differently. Each part costs a pose what it lacks of the most
/// evidence that it can give; an adaptation weighs these costs anew and shifts all log odds. A pose
/// that lacks nothing keeps its score but for the shift.
struct ScoreAdaptation {
  float shift = 0;                             ///< of the log odds
  std::array<float, kNumScoreParts> weights =  ///< of the costs, 0..kMaxCostWeight; 1 as before
      [] {
        std::array<float, kNumScoreParts> ones{};
        ones.fill(1);
        return ones;
      }();
  bool operator==(const ScoreAdaptation&) const = default;
};

inline constexpr float kMaxCostWeight = 3;

/// The most by which an adaptation from marked poses raises the log odds of any pose: its odds grow
/// no more than tenfold, whatever was marked. What had less than 0.09 stays below 0.5, and what had
/// less than 0.28 below 0.8.
inline constexpr float kMaxRaise = 2.3025851F;

/// The most that a part can add to the log odds where errors are independent [0], shared [1].
std::array<float, 2> most_evidence(const ScoreModel& model, std::size_t part) noexcept;

/// The model that scores as adapted. As additive and as monotone as before.
ScoreModel adapted_score(const ScoreModel& model, const ScoreAdaptation& adaptation) noexcept;

/// By how much an adaptation raises the log odds of a pose at the very most, over all poses that
/// there could be; not negative.
float largest_raise(const ScoreModel& model, const ScoreAdaptation& adaptation) noexcept;

/// So much of the way from no adaptation to this one, 0..1.
ScoreAdaptation part_of_the_way(const ScoreAdaptation& adaptation, float share) noexcept;

/// Fit an adaptation: the most probable one under a Gaussian prior around none, with a standard
/// deviation of 0.5 for the shift and 0.7 for each weight, among those that raise no pose by more
/// than kMaxRaise. Without rows it is none.
///
/// parts  n, all finite
/// right  n; 1 where the pose is right, else 0
/// The same bits for any order of the rows. Source: Zhang and Oles, Information Retrieval 2001
/// (coordinate descent with trust regions, under a Gaussian prior).
ScoreAdaptation fit_adaptation(const ScoreModel& model, std::span<const ScoreParts> parts,
                               std::span<const std::uint8_t> right);

}  // namespace trivet::kernels
