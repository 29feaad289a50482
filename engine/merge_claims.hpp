/// One answer out of several: of a scene that libraries were looked for one by one.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/recognize.hpp"
#include "storage/result.hpp"

namespace trivet {

/// A detection among the results of several libraries.
struct DetectionPlace {
  std::size_t library = 0, detection = 0;  ///< indices
  bool operator==(const DetectionPlace&) const = default;
};

/// Tell which detections stand when the poses that were taken in several libraries are selected
/// together: as those of one library are, by the pixels that better ones explain. What a library
/// refused stays refused. All libraries have one unit of length.
///
/// libraries  claims of one scene, one a library
/// Returns the detections in the order of choice; ties go to the earlier library.
/// Errors: bad_data (the scene was looked at in other images: other options, or another scene).
Result<std::vector<DetectionPlace>> merge_claims(std::span<const SceneClaims> libraries);

}  // namespace trivet
