#include "kernels/scans/sparse_grid.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

template <class Measured>
PixelGrid grid_of(const Measured& measured) {
  PixelGrid grid{.width = 90, .height = 60, .point_index = {}};
  std::int32_t point = 0;
  for (std::uint32_t v = 0; v < grid.height; ++v) {
    for (std::uint32_t u = 0; u < grid.width; ++u)
      grid.point_index.push_back(measured(u, v) ? point++ : PixelGrid::kNone);
  }
  return grid;
}

TEST(SparseGrid, IsOneThinnedByRowsColumnsOrBlocks) {
  using Pixel = std::uint32_t;
  EXPECT_TRUE(is_sparse(grid_of([](Pixel, Pixel v) { return v % 2 == 0; })));
  EXPECT_TRUE(is_sparse(grid_of([](Pixel u, Pixel) { return u % 3 == 0; })));
  EXPECT_TRUE(is_sparse(grid_of([](Pixel, Pixel v) { return v % 3 != 0; })));
  EXPECT_TRUE(is_sparse(grid_of([](Pixel u, Pixel v) { return (u + v) % 2 == 0; })));
  EXPECT_TRUE(is_sparse(grid_of([](Pixel u, Pixel v) { return u % 2 == 0 && v % 2 == 0; })));
}

TEST(SparseGrid, IsNoImageWithHoles) {
  test::Random random;
  using Pixel = std::uint32_t;
  EXPECT_FALSE(is_sparse(grid_of([](Pixel, Pixel) { return true; })));
  EXPECT_FALSE(is_sparse(grid_of([](Pixel u, Pixel v) { return u < 40 && v > 10; })));
  EXPECT_FALSE(is_sparse(grid_of([&](Pixel, Pixel) { return random.below(10) >= 2; })));
  EXPECT_FALSE(is_sparse(grid_of([](Pixel, Pixel) { return false; })));
}

}  // namespace
}  // namespace trivet::kernels
