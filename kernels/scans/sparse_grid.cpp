#include "kernels/scans/sparse_grid.hpp"

#include <cstddef>

namespace trivet::kernels {
namespace {

constexpr double kFewestNeighbors = 5.3;

}  // namespace

bool is_sparse(const PixelGrid& grid) noexcept {
  const auto width = static_cast<std::ptrdiff_t>(grid.width),
             height = static_cast<std::ptrdiff_t>(grid.height);
  const auto is_measured = [&](std::ptrdiff_t u, std::ptrdiff_t v) {
    return u >= 0 && v >= 0 && u < width && v < height &&
           grid.point_index[static_cast<std::size_t>(v * width + u)] != PixelGrid::kNone;
  };
  std::size_t num_measured = 0, num_neighbors = 0;
  for (std::ptrdiff_t v = 0; v < height; ++v) {
    for (std::ptrdiff_t u = 0; u < width; ++u) {
      if (!is_measured(u, v)) continue;
      ++num_measured;
      for (std::ptrdiff_t y = v - 1; y <= v + 1; ++y) {
        for (std::ptrdiff_t x = u - 1; x <= u + 1; ++x)
          num_neighbors += is_measured(x, y) && (x != u || y != v) ? 1 : 0;
      }
    }
  }
  return static_cast<double>(num_neighbors) < kFewestNeighbors * static_cast<double>(num_measured);
}

}  // namespace trivet::kernels
