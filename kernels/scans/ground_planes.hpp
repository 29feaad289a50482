/// The planes of a scan that everything measured lies on or before: tables, floors, walls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scans/find_planes.hpp"
#include "kernels/scans/range_image.hpp"

namespace trivet::kernels {

/// For each plane: 1 if nothing is measured behind it anywhere in the image, else 0.
///
/// The face of a plate or of a block has the table behind it, beyond its edges or in its holes: it
/// is the face of a body, and other bodies may be let into that. Behind the plane on which the
/// scene stands, nothing is seen. A plane is told from the surfaces behind it if both scatter
/// apart: if these are farther than twice its thickness.
///
/// planes   those that the image is labeled with, in the camera's frame
/// opening  the fewest connected pixels behind a plane that are no stray measurements, > 0
/// Cost: the pixels times the planes. Allocates.
std::vector<std::uint8_t> find_ground(const RangeImage& image, std::span<const Plane> planes,
                                      std::size_t opening);

}  // namespace trivet::kernels
