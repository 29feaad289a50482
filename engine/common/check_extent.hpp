/// Lengths that floats can be computed with.
#pragma once

#include <string>

#include "storage/common/result.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

/// Check that the points span neither so little that products of distances between neighbors vanish
/// in floats, nor so much that they overflow: between 1e-6 and 1e9, in any unit. One point, or many
/// in one place, span nothing.
///
/// points  in the library's unit, finite
/// name    of the file or cloud, for the error
/// Errors: bad_data.
Result<void> check_extent(PointsView points, const std::string& name);

}  // namespace trivet::engine
