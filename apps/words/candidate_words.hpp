/// What tells a candidate from the model named first, in words.
#pragma once

#include <string>
#include <string_view>

#include "engine/results/recognize_result.hpp"

namespace trivet::apps {

/// "block_b 0.38: differs by up to 8 mm around (x, y, z); not seen from here, seen from (x, y, z)".
/// Only the name and the share for the first candidate. The place is in the frame of the scene's
/// file; the last vector points from it to where it is seen from.
///
/// offset  of the scene (SceneResult::offset)
/// unit    name of the scene's unit
std::string candidate_words(const Candidate& candidate, const Eigen::Vector3d& offset,
                            std::string_view unit);

}  // namespace trivet::apps
