/// What all formats have in common behind the reader.
#pragma once

#include "storage/cloud.hpp"
#include "storage/files/input.hpp"

namespace trivet::formats {

/// Drop points that are not finite, with their triangles and pixels; zero normals that are not.
///
/// Errors: bad_data when no point is left, a coordinate is beyond 1e7, or the cloud is so small
/// beside its distance from the origin that float cannot tell its points apart.
Result<Cloud> finish(Cloud cloud, const Input& input);

}  // namespace trivet::formats
