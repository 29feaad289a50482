/// Check of lengths for float arithmetic.
#pragma once

#include <string>

#include "storage/common/result.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

/// Check the extent of points: it must be neither so small that products of distances between
/// neighbors underflow in floats, nor so large that they overflow. The limits are 1e-6 and 1e9, in
/// any unit. A single point, or coincident points, have no extent.
///
/// points  finite points in the library's unit
/// name    name of the file or cloud, for the error
/// Errors: bad_data (an extent out of range).
Result<void> check_extent(PointsView points, const std::string& name);

}  // namespace trivet::engine
