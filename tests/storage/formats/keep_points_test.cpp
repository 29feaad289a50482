#include "storage/formats/keep_points.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"

namespace trivet {
namespace {

/// 5 x 4 pixels, every third with a point. Points are numbered against the order of the pixels.
Cloud organized() {
  Cloud cloud;
  cloud.grid = PixelGrid{5, 4, {}};
  cloud.grid->point_index.assign(20, PixelGrid::kNone);
  for (std::int32_t point = 0; point < 7; ++point) {
    cloud.points.push_back(Eigen::Vector3f::Constant(static_cast<float>(point)));
    cloud.normals.push_back(Eigen::Vector3f::Constant(static_cast<float>(-point)));
    cloud.intensity.push_back(static_cast<float>(10 * point));
    cloud.grid->point_index[static_cast<std::size_t>(18 - 3 * point)] = point;
  }
  cloud.triangles.push_back(0, 1, 2);
  cloud.triangles.push_back(2, 3, 4);
  cloud.triangles.push_back(6, 4, 2);
  return cloud;
}

TEST(KeepPoints, KeepsTheMarkedOnesWithWhatBelongsToThem) {
  Cloud cloud = organized();
  keep_points(std::vector<std::uint8_t>{0, 1, 1, 0, 1, 0, 1}, cloud);
  ASSERT_EQ(cloud.points.size(), 4U);
  ASSERT_EQ(cloud.normals.size(), 4U);
  ASSERT_EQ(cloud.intensity.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const float number = std::array{1.0F, 2.0F, 4.0F, 6.0F}[i];
    EXPECT_EQ(cloud.points[i].x(), number);
    EXPECT_EQ(cloud.normals[i].x(), -number);
    EXPECT_EQ(cloud.intensity[i], 10 * number);
  }
  ASSERT_EQ(cloud.triangles.size(), 1U) << "the others have lost a corner";
  EXPECT_EQ(cloud.triangles.a[0], 3U);
  EXPECT_EQ(cloud.triangles.b[0], 2U);
  EXPECT_EQ(cloud.triangles.c[0], 1U);
}

TEST(KeepPoints, LeavesEveryPixelItsPoint) {
  const Cloud before = organized();
  for (unsigned marks = 0; marks < 128; ++marks) {
    std::vector<std::uint8_t> keep;
    for (unsigned i = 0; i < 7; ++i) keep.push_back((marks >> i) & 1U);
    Cloud cloud = before;
    keep_points(keep, cloud);
    for (std::size_t pixel = 0; pixel < 20; ++pixel) {
      const std::int32_t point = before.grid->point_index[pixel];
      const std::int32_t now = cloud.grid->point_index[pixel];
      if (point == PixelGrid::kNone || keep[static_cast<std::size_t>(point)] == 0) {
        EXPECT_EQ(now, PixelGrid::kNone);
      } else {
        ASSERT_GE(now, 0);
        ASSERT_LT(static_cast<std::size_t>(now), cloud.points.size());
        EXPECT_EQ(cloud.points[static_cast<std::size_t>(now)],
                  before.points[static_cast<std::size_t>(point)]);
      }
    }
  }
}

TEST(KeepPoints, AcceptsCloudsOfPointsOnly) {
  Cloud cloud;
  keep_points({}, cloud);
  EXPECT_TRUE(cloud.points.empty());
  cloud.points = test::Random().dyadic_cloud(3);
  keep_points(std::vector<std::uint8_t>{1, 0, 1}, cloud);
  EXPECT_EQ(cloud.points.size(), 2U);
  EXPECT_TRUE(cloud.normals.empty() && cloud.triangles.empty() && !cloud.grid);
}

}  // namespace
}  // namespace trivet
