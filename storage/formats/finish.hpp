/// What all formats have in common behind the reader.
#pragma once

#include <new>
#include <stdexcept>

#include "storage/data/cloud.hpp"
#include "storage/files/input.hpp"

namespace trivet::formats {

/// Drop points that are not finite, with their triangles and pixels; zero normals that are not. Of
/// models with faces (ReadOptions::keep_origin), drop vertices that no face with an area uses, and
/// the faces that use them.
///
/// Errors: bad_data when no point is left, a coordinate is beyond 1e7, or the cloud is so small
/// beside its distance from the origin that float cannot tell its points apart.
Result<Cloud> finish(Cloud cloud, const Input& input);

/// What `read` gives, or no_memory where the memory does not suffice for it.
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
