#include <gtest/gtest.h>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/random.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

TEST(WritePly, IsReadBackToTheSameBits) {
  const test::TempDir folder;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    test::Random random(seed);
    Cloud cloud;
    const std::uint32_t n = 1 + random.below(300);
    cloud.points = random.surface(n);
    if (seed % 2 == 0) cloud.normals = random.surface(n);
    for (std::uint32_t t = seed % 3 == 0 ? random.below(500) : 0; t > 0; --t) {
      cloud.triangles.push_back(random.below(n), random.below(n), random.below(n));
    }
    ASSERT_TRUE(write_ply(folder / "a.ply", cloud));
    const auto again = read_cloud(folder / "a.ply");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_TRUE(test::is_valid(*again));
    EXPECT_TRUE(test::same_bits(again->points, cloud.points)) << "seed " << seed;
    EXPECT_TRUE(test::same_bits(again->normals, cloud.normals)) << "seed " << seed;
    EXPECT_EQ(again->triangles.a, cloud.triangles.a);
    EXPECT_EQ(again->triangles.b, cloud.triangles.b);
    EXPECT_EQ(again->triangles.c, cloud.triangles.c);
  }
}

TEST(WritePly, SaysThatItCannotCreateTheFile) {
  const test::TempDir folder;
  Cloud cloud;
  cloud.points.push_back({1, 2, 3});
  const auto written = write_ply(folder / "none" / "a.ply", cloud);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::cannot_create);
}

}  // namespace
}  // namespace trivet
