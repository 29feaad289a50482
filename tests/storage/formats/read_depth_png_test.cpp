// Depth images in PNG files.
#include <gtest/gtest.h>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::is_refused;
using test::kCamera;
using test::kReadOptions;

class ReadDepthPng : public testing::Test {
 protected:
  Result<Cloud> read(const std::string& bytes, const ReadOptions& options = kReadOptions) {
    return read_cloud(folder_.write("depth.png", bytes), options);
  }
  test::TempDir folder_;
};

TEST_F(ReadDepthPng, PutsEachPixelInFrontOfTheCamera) {
  const auto cloud = read(test::depth_png(3, 2, {1000, 0, 2000, 3000, 0, 65535}));
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_TRUE(test::is_valid(*cloud));
  EXPECT_EQ(cloud->camera, kCamera);
  EXPECT_EQ(cloud->viewpoint, Eigen::Vector3f(0, 0, 0));
  ASSERT_TRUE(cloud->grid);
  EXPECT_EQ(cloud->grid->width, 3U);
  EXPECT_EQ(cloud->grid->point_index, (Column<std::int32_t>{0, -1, 1, 2, -1, 3}));
  const double depths[] = {1, 2, 3, 65.535};
  const int u[] = {0, 2, 0, 2}, v[] = {0, 0, 1, 1};
  for (std::size_t i = 0; i < 4; ++i) {
    // A float has 24 bits: half a unit in the last place is 6e-8 of the value.
    const Eigen::Vector3d expected((u[i] - kCamera.cx) / kCamera.fx * depths[i],
                                   (v[i] - kCamera.cy) / kCamera.fy * depths[i], depths[i]);
    EXPECT_LT((cloud->points[i].cast<double>() - expected).norm(), 1e-7 * depths[i]);
  }
}

TEST_F(ReadDepthPng, SaysHowToGiveACamera) {
  const std::string image = test::depth_png(1, 1, {1});
  EXPECT_TRUE(is_refused(read(image, {}), "--camera CAMERA.json"));
  for (const Camera& broken : {Camera{0, 1, 0, 0, 1}, Camera{1, -1, 0, 0, 1},
                               Camera{1, 1, 0.0 / 0.0, 0, 1}, Camera{1, 1, 0, 0, 0}}) {
    EXPECT_TRUE(is_refused(read(image, {.camera = broken}), "above zero"));
  }
}

TEST_F(ReadDepthPng, RefusesWhatHoldsNoDepths) {
  EXPECT_TRUE(is_refused(read(test::png_file(1, 1, 8, 0, std::string(2, '\1'))), "8 bits"));
  EXPECT_TRUE(is_refused(read(test::png_file(1, 1, 16, 2, std::string(7, '\1'))), "color type 2"));
  EXPECT_TRUE(is_refused(read("\x89PNG, but not really a PNG file, only a text"), "signature"));
}

// A covered camera, or nothing within its range, still gives a valid scene.
TEST_F(ReadDepthPng, ReadsAnImageWithoutAnyMeasurement) {
  const auto cloud = read(test::depth_png(2, 2, {0, 0, 0, 0}), {.camera = kCamera});
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_TRUE(cloud->points.empty());
  ASSERT_TRUE(cloud->grid);
  EXPECT_EQ(cloud->grid->point_index.size(), 4U);
}

TEST_F(ReadDepthPng, RefusesSizesThatLieBeforeDecoding) {
  const std::string row(3, '\1');
  EXPECT_TRUE(is_refused(read(test::png_file(50000, 50000, 16, 0, row)), "50000 x 50000"));
  EXPECT_TRUE(is_refused(read(test::png_file(0xFFFFFFFF, 0xFFFFFFFF, 16, 0, row)), "pixels"));
  EXPECT_TRUE(is_refused(read(test::png_file(8000, 8000, 16, 0, row)), "truncated"));
  EXPECT_TRUE(is_refused(read(test::png_file(0, 1, 16, 0, row)), "0 x 1"));
  EXPECT_TRUE(is_refused(read(test::png_file(1, 2, 16, 0, row)), "decoded"));
  EXPECT_TRUE(
      is_refused(read(test::depth_png(2, 2, {1, 2, 3, 4}), {.camera = kCamera, .max_pixels = 3}),
                 "1 to 3 pixels"));
}

TEST_F(ReadDepthPng, RefusesAnImageOfAnotherSizeThanItsCamera) {
  Camera camera = kCamera;
  camera.width = 2, camera.height = 2;
  const std::string image = test::depth_png(2, 2, {1, 2, 3, 4});
  EXPECT_TRUE(read(image, {.camera = camera}));
  camera.width = 320, camera.height = 260;
  EXPECT_TRUE(is_refused(read(image, {.camera = camera}),
                         "expected an image of 320 x 260 pixels, as its camera's, found 2 x 2"));
  camera.width = 0;
  EXPECT_TRUE(is_refused(read(image, {.camera = camera}), "any x 260"));
}

}  // namespace
}  // namespace trivet
