/// Fit a score to poses of which it is known whether they are right.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/verification/pose_score.hpp"

namespace trivet::kernels {

/// Minimize sum log loss + ridge / 2 sum weight^2 over all weights >= 0.
///
/// parts  n, all finite; their 3 and 97 % quantiles become the outer knots, the others lie at equal
///        distances between
/// right  n; 1 where the pose is right, else 0
/// ridge  > 0: without it a part that divides the poses perfectly would have no bound
/// The same bits whenever the rows are the same. Source: Zhang and Oles, Information Retrieval 2001
/// (coordinate descent with trust regions, which converges for this convex problem).
ScoreModel fit_score(std::span<const ScoreParts> parts, std::span<const std::uint8_t> right,
                     double ridge);

/// Mean log loss of a model over such rows; the smaller the better.
double log_loss(const ScoreModel& model, std::span<const ScoreParts> parts,
                std::span<const std::uint8_t> right) noexcept;

}  // namespace trivet::kernels
