#include <gtest/gtest.h>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/random.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

/// Random points, some with signed zeros, each a corner of a triangle.
Cloud random_mesh(test::Random& random, bool with_normals) {
  Cloud cloud;
  const std::uint32_t n = 3 + random.below(300);
  cloud.points = random.surface(n);
  cloud.points.set(0, {-0.0F, 1e-30F, 3e6F});
  if (with_normals) cloud.normals = random.surface(n);
  for (std::uint32_t v = 0; v < n; ++v)
    cloud.triangles.push_back(random.below(n), v, random.below(n));
  return cloud;
}

TEST(WriteGltf, IsReadBackToTheSameBits) {
  const test::TempDir folder;
  const auto file = folder / "a.glb";
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    test::Random random(seed);
    Cloud cloud = random_mesh(random, seed % 2 == 0);
    if (seed % 5 == 0) cloud.triangles = {};
    for (const LengthUnit unit : {LengthUnit::meter, LengthUnit::millimeter}) {
      ASSERT_TRUE(write_glb(file, cloud, unit));
      const auto again = read_cloud(file, {.unit = unit});
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_TRUE(test::is_valid(*again));
      EXPECT_TRUE(test::same_bits(again->points, cloud.points)) << "seed " << seed;
      EXPECT_EQ(again->normals.size(), cloud.normals.size());
      EXPECT_EQ(again->triangles.a, cloud.triangles.a);
      EXPECT_EQ(again->triangles.b, cloud.triangles.b);
      EXPECT_EQ(again->triangles.c, cloud.triangles.c);
    }
  }
}

TEST(WriteGltf, IsInMetersForWhoeverReadsIt) {
  const test::TempDir folder;
  Cloud cloud;
  cloud.points.push_back({1000, 0, 0});
  cloud.points.push_back({0, 2000, 0});
  cloud.points.push_back({0, 0, 3000});
  cloud.triangles.push_back(0, 1, 2);
  ASSERT_TRUE(write_glb(folder / "a.glb", cloud, LengthUnit::millimeter));
  const auto read = read_cloud(folder / "a.glb", {.unit = LengthUnit::meter});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->points[0].x(), 1.0F);
  EXPECT_EQ(read->points[2].z(), 3.0F);
}

TEST(WriteGltf, SaysThatItCannotCreateTheFile) {
  const test::TempDir folder;
  Cloud cloud;
  cloud.points.push_back({1, 2, 3});
  const auto written = write_glb(folder / "none" / "a.glb", cloud, LengthUnit::meter);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::cannot_create);
}

}  // namespace
}  // namespace trivet
