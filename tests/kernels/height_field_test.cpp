#include "kernels/height_field.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

/// Samples of a body between two heights over the square [x, x + 1] x [y, y + 1], 0.1 apart.
Points slab(float x, float y, float low, float high) {
  Points samples;
  for (int i = 0; i <= 10; ++i) {
    for (int j = 0; j <= 10; ++j) {
      for (const float z : {low, high}) {
        samples.push_back({x + 0.1F * static_cast<float>(i), y + 0.1F * static_cast<float>(j), z});
      }
    }
  }
  return samples;
}

TEST(HeightField, BringsTheLowestPointToThePlane) {
  const HeightField field(5, 0.125F);
  EXPECT_EQ(field.rest(slab(0, 0, 2, 3)), -2);
  EXPECT_EQ(field.rest(slab(0, 0, -4, 3)), 4);
  EXPECT_EQ(field.rest(slab(100, -1e9F, 1, 3)), -1) << "outside the grid lies the bare plane";
}

TEST(HeightField, LaysBodiesOnWhatIsBelowThemOnly) {
  HeightField field(5, 0.125F);
  field.add(slab(0, 0, 0, 2), 0.5F);
  EXPECT_EQ(field.rest(slab(0.5F, 0.5F, 0, 1)), 2.5F);
  EXPECT_EQ(field.rest(slab(1.5F, 0, 0, 1)), 0) << "beside it";
  field.add(slab(0.5F, 0.5F, 0, 1), 2.5F);
  EXPECT_EQ(field.rest(slab(1, 1, 0, 1)), 3.5F);
}

TEST(HeightField, NeverLetsBodiesEnterEachOther) {
  HeightField field(3, 0.125F);
  struct Slab {
    float x, y, low, high;
  };
  std::vector<Slab> placed;
  test::Random random;
  for (int i = 0; i < 40; ++i) {
    const float x = random.uniform(-2, 1), y = random.uniform(-2, 1),
                high = random.uniform(0.1F, 1);
    const Points samples = slab(x, y, 0, high);
    const float lift = field.rest(samples);
    field.add(samples, lift);
    for (const Slab& other : placed) {
      const bool apart = std::abs(x - other.x) > 1 || std::abs(y - other.y) > 1;
      EXPECT_TRUE(apart || lift >= other.high || lift + high <= other.low);
    }
    placed.push_back({x, y, lift, lift + high});
  }
}

}  // namespace
}  // namespace trivet::kernels
