/// Whether the pixels of a scan have enough neighbors for an image.
#pragma once

#include "storage/data/cloud.hpp"

namespace trivet::kernels {

/// Whether measured pixels have on average fewer than 5.3 measured ones among their eight neighbors,
/// as images have that were thinned by rows, columns or blocks: their points are a cloud. Scans of
/// cameras have 7.3 and more, and images that lack 30 % of their pixels at random 5.6.
bool is_sparse(const PixelGrid& grid) noexcept;

}  // namespace trivet::kernels
