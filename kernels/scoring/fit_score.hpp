/// Training of a score from poses with known correctness.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/scoring/pose_score.hpp"

namespace trivet::kernels {

/// Minimize sum log loss + ridge / 2 sum weight^2 over all weights >= 0.
///
/// parts  n, all finite; their 3 and 97 % quantiles become the outer knots, the others are equally
///        spaced between
/// right  n; 1 if the pose is right, else 0
/// ridge  > 0: without it a part that separates the poses perfectly would have an unbounded weight
/// The same rows give the same bits. Source: Zhang and Oles, Information Retrieval 2001 (coordinate
/// descent with trust regions, which converges for this convex problem).
ScoreModel fit_score(std::span<const ScoreParts> parts, std::span<const std::uint8_t> right,
                     double ridge);

/// Mean log loss of a model over such rows; smaller is better.
double log_loss(const ScoreModel& model, std::span<const ScoreParts> parts,
                std::span<const std::uint8_t> right) noexcept;

}  // namespace trivet::kernels
