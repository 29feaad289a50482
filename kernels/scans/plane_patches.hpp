/// The largest connected patch of each plane in an image.
#pragma once

#include <cstddef>
#include <vector>

#include "kernels/scans/find_planes.hpp"
#include "kernels/scans/range_image.hpp"

namespace trivet::kernels {

/// Areas of the largest patches of connected pixels near each plane, by position (near_plane)
/// [scene unit^2]. Parts that lie beside one another at one height share a plane, but no patch.
///
/// planes  those that the image is labeled with, in the camera's frame
std::vector<float> largest_patches(const RangeImage& image, std::span<const Plane> planes);

}  // namespace trivet::kernels
