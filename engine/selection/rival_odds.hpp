/// How likely one answer is right rather than another one of its place.
#pragma once

#include "engine/verification/candidate.hpp"
#include "kernels/verification/compare_poses.hpp"

namespace trivet::engine {

/// The logarithm of the odds that `candidate` is right and not `other`: by the pixels in which they
/// differ and by the scores, which see the others, too.
///
/// comparison  of the candidate with the other
double rival_log_odds(const Candidate& candidate, const Candidate& other,
                      const kernels::PoseComparison& comparison) noexcept;

}  // namespace trivet::engine
