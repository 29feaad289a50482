/// Common checks of all formats after reading.
#pragma once

#include <new>
#include <stdexcept>

#include "storage/data/cloud.hpp"
#include "storage/files/input.hpp"

namespace trivet::formats {

/// Drop non-finite points with their triangles and pixels; set non-finite normals to zero. For
/// models with faces (ReadOptions::keep_origin), also drop vertices that no face with nonzero area
/// uses, and the faces that use them.
///
/// Errors: bad_data if no point is left, a coordinate is beyond 1e7, or the cloud is so small
/// relative to its distance from the origin that floats cannot distinguish its points.
Result<Cloud> finish(Cloud cloud, const Input& input);

/// Result of `read`, or no_memory if memory runs out.
template <class Read>
Result<Cloud> within_memory(const Input& input, Read&& read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::no_memory, input.refuse(kOutOfMemory).message};
  } catch (const std::length_error&) {
    return Error{ErrorCode::no_memory, input.refuse(kOutOfMemory).message};
  }
}

}  // namespace trivet::formats
