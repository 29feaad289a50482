/// Poses that the caller expects, for example from an earlier scene.
#pragma once

#include <span>
#include <vector>

#include "engine/hypotheses/proposals.hpp"
#include "engine/options/pose_limits.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Propose the expected poses of the models to search for, each with one vote.
///
/// expected  poses in the cloud's frame and unit
/// scale     factor from that unit to the library's
std::vector<Proposals> propose_expected(const Library& library, const ModelGroups& groups,
                                        std::span<const ExpectedPose> expected, double scale);

}  // namespace trivet::engine
