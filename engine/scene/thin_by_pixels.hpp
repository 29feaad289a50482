/// A subset of points spread evenly over the pixels of a scan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/scene/prepare_scene.hpp"

namespace trivet::engine {

/// Keep at most `limit` points, evenly among the pixels of the scan rather than on its surfaces, so
/// that an object's share of them is its share of the image, however large what is behind it is.
/// Among points of a closed surface, which is measured from all sides, evenly.
///
/// points   in the scene's frame
/// indices  of points, rising; those kept are moved to the front
/// Returns the number kept.
std::size_t thin_by_pixels(const PreparedScene& scene, const Points& points, std::size_t limit,
                           std::span<std::uint32_t> indices);

}  // namespace trivet::engine
