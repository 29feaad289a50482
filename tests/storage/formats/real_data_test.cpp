// Tests on the development data: real scans, read whole.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "storage/datasets/manifest.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

class RealData : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::is_directory(data_)) GTEST_SKIP() << "no development data in " << data_;
  }
  const fs::path data_ = TRIVET_DATA;
};

TEST_F(RealData, EveryModelAndSceneOfEveryManifestIsRead) {
  std::set<fs::path> read;
  for (const auto& entry : fs::recursive_directory_iterator(data_)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("manifest") || entry.path().extension() != ".json") continue;
    const auto manifest = read_manifest(entry.path());
    ASSERT_TRUE(manifest) << manifest.error().message;
    for (const auto& model : manifest->models) {
      if (!read.insert(fs::weakly_canonical(model.file)).second) continue;
      const auto cloud = read_cloud(model.file);
      ASSERT_TRUE(cloud) << cloud.error().message;
      EXPECT_TRUE(test::is_valid(*cloud)) << model.file;
      EXPECT_FALSE(cloud->viewpoint) << model.file;
    }
    for (const auto& scene : manifest->scenes) {
      const auto cloud = read_cloud(scene.file, {.camera = scene.camera});
      ASSERT_TRUE(cloud) << cloud.error().message;
      EXPECT_TRUE(test::is_valid(*cloud)) << scene.file;
      EXPECT_GT(cloud->points.size(), 5000U) << scene.file;
      EXPECT_EQ(cloud->camera, scene.camera) << scene.file;
    }
  }
}

TEST_F(RealData, CountsAreTheKnownOnes) {
  struct Known {
    const char* file;
    std::size_t points, normals, triangles, invalid;
    std::uint32_t width, height;
  };
  for (const Known& known : std::initializer_list<Known>{
           {"uwa/scenes/rs1.pcd", 289541, 0, 0, 0, 0, 0},
           {"uwa/models/chef.pcd", 5092, 5092, 0, 0, 0, 0},
           {"uwa/models/chicken2.ply", 33368, 33368, 66451, 0, 0, 0},
           {"stanford_bunny_scans/bun000.ply", 40256, 0, 0, 0, 512, 400},
           {"stanford_bunny_scans/model/bun_zipper.ply", 35947, 0, 69451, 0, 0, 0},
           {"pcl_kinect/milk_cartoon_all_small_clorox.pcd", 241407, 0, 0, 65793, 640, 480},
           {"pcl_kinect/bun0.pcd", 397, 397, 0, 0, 0, 0},
           {"pipes_bin/Pipe_01.ply", 168, 0, 332, 0, 0, 0},
           {"meshes/industrial/gear.ply", 16704, 0, 33407, 0, 0, 0},
           {"meshes/industrial/IPAGearShaft.stl", 1163, 0, 2322, 0, 0, 0},
           {"meshes/industrial/bolt.stl", 88, 0, 164, 0, 0, 0},
           {"meshes/common/cow.obj", 2903, 0, 5804, 0, 0, 0},
           {"meshes/common/spot.obj", 2930, 0, 5856, 0, 0, 0},
           {"ycbv/models/025_mug/points.xyz", 2621, 0, 0, 0, 0, 0},
           {"kinect_bunny/cloudXYZ_9.xyz", 8348, 8348, 0, 0, 0, 0}}) {
    const auto cloud = read_cloud(data_ / known.file);
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_EQ(cloud->points.size(), known.points) << known.file;
    EXPECT_EQ(cloud->normals.size(), known.normals) << known.file;
    EXPECT_EQ(cloud->triangles.size(), known.triangles) << known.file;
    EXPECT_EQ(cloud->num_invalid, known.invalid) << known.file;
    EXPECT_EQ(cloud->grid ? cloud->grid->width : 0, known.width) << known.file;
    EXPECT_EQ(cloud->grid ? cloud->grid->height : 0, known.height) << known.file;
  }
}

TEST_F(RealData, TheGridOfAScanHoldsItsPointsInOrder) {
  // Neighboring pixels of a row hold neighboring points, so the grid is not transposed.
  const auto cloud = read_cloud(data_ / "stanford_bunny_scans/bun000.ply");
  ASSERT_TRUE(cloud && cloud->grid);
  const PixelGrid& grid = *cloud->grid;
  std::size_t near = 0, pairs = 0;
  for (std::size_t pixel = 0; pixel + 1 < grid.point_index.size(); ++pixel) {
    const std::int32_t a = grid.point_index[pixel], b = grid.point_index[pixel + 1];
    if (a < 0 || b < 0 || (pixel + 1) % grid.width == 0) continue;
    ++pairs;
    near +=
        (cloud->points[static_cast<std::size_t>(a)] - cloud->points[static_cast<std::size_t>(b)])
            .norm() < 0.002F;
  }
  EXPECT_GT(pairs, 30000U);
  EXPECT_GT(near, pairs * 9 / 10);
}

}  // namespace
}  // namespace trivet
