/// Choose the set of candidates that together explain the scene.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/candidate.hpp"
#include "engine/prepare_scene.hpp"
#include "engine/recognise.hpp"

namespace trivet::engine {

struct Selection {
  std::vector<std::uint32_t> chosen;  ///< indices of the candidates taken, in the order of taking
  std::vector<std::uint8_t>
      explained;  ///< one a pixel over all images: 1 where a sure one explains it
};

/// Take candidates by falling score x area^0.25 (large surfaces prove more), each unless better
/// ones already explain more than max_overlap of its pixels: copies of one object fall out whatever
/// their symmetry, and of two objects claiming one place the better explained stays. Ties go to the
/// earlier candidate. Doubtful candidates come after all others.
Selection select_detections(const Library& library, const PreparedScene& scene,
                            std::span<const Candidate> candidates, const RecogniseOptions& options);

}  // namespace trivet::engine
