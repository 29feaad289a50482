/// Makes meshes of scans from the command line, as a script does.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "apps/program.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

class MeshCommand : public testing::Test {
 protected:
  test::Outcome run(const std::vector<std::string>& arguments) const {
    return test::run_trivet(arguments, {.folder = folder_.path(), .environment = {}, .watch = {}});
  }
  /// Makes out.ply and reads it.
  Cloud mesh(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "mesh");
    arguments.insert(arguments.end(), {"-o", "out.ply"});
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_NE(outcome.error.find("out.ply: "), std::string::npos) << outcome.error;
    EXPECT_TRUE(outcome.out.empty()) << outcome.out;
    Result<Cloud> cloud = read_cloud(folder_ / "out.ply");
    EXPECT_TRUE(cloud) << cloud.error().message;
    return cloud ? std::move(*cloud) : Cloud{};
  }
  void fails(std::vector<std::string> arguments, int code, const std::string& text) const {
    arguments.insert(arguments.begin(), "mesh");
    const test::Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, code) << outcome.error;
    EXPECT_NE(outcome.error.find(text), std::string::npos) << outcome.error;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.ply"));
  }
  /// A square of 10 x 10 points, one per line.
  void write_square(const std::string& name, const std::string& normal = {}) const {
    std::string text;
    for (int i = 0; i < 100; ++i) {
      text += std::to_string(i % 10) + " " + std::to_string(i / 10) + " 20" + normal + "\n";
    }
    folder_.write(name, text);
  }
  const test::TempDir folder_;
};

TEST_F(MeshCommand, KeepsTheFacesOfAFile) {
  folder_.write("pyramid.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n");
  const Cloud cloud = mesh({"pyramid.off"});
  EXPECT_EQ(cloud.points.size(), 4U);
  EXPECT_EQ(cloud.triangles.a, (Column<std::uint32_t>{0, 0}));
  EXPECT_EQ(cloud.triangles.b, (Column<std::uint32_t>{2, 1}));
}

TEST_F(MeshCommand, PrintsLargeSharesAsIntegers) {
  folder_.write("triangle.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 2 1\n");
  const test::Outcome outcome = run({"mesh", "triangle.off", "-o", "out.ply"});
  EXPECT_NE(outcome.error.find(", 100 % of the edges open,"), std::string::npos) << outcome.error;
}

TEST_F(MeshCommand, SpansTheSquaresOfADepthImage) {
  // A plane whose right half has another depth, with one missing pixel.
  std::vector<std::uint16_t> depths;
  for (int i = 0; i < 20 * 10; ++i) depths.push_back(i % 20 < 10 ? 1000 : 1500);
  depths[3 * 20 + 4] = 0;
  folder_.write("depth.png", test::depth_png(20, 10, depths));
  folder_.write("camera.json",
                R"({"fx": 500, "fy": 500, "cx": 10, "cy": 5, "depth_scale": 0.001})");
  const Cloud cloud = mesh({"depth.png", "--camera", "camera.json"});
  EXPECT_EQ(cloud.points.size(), 199U);
  EXPECT_EQ(cloud.triangles.size(), 2U * 18 * 9 - 4);
  EXPECT_EQ(cloud.points[0].z(), 1);
  EXPECT_EQ(
      mesh({"depth.png", "--camera", "camera.json", "--max-jump", "1000", "--max-grazing", "89.9"})
          .triangles.size(),
      2U * 19 * 9 - 4);
}

TEST_F(MeshCommand, LaysASurfaceThroughPointsThatFacesTheViewpoint) {
  write_square("points.xyz");
  for (const std::string z : {"0", "40"}) {
    const Cloud cloud = mesh({"points.xyz", "--viewpoint", "5,5," + z});
    ASSERT_EQ(cloud.triangles.size(), 2U * 81);
    const Eigen::Vector3f a = cloud.points[cloud.triangles.a[0]];
    const float up =
        (cloud.points[cloud.triangles.b[0]] - a).cross(cloud.points[cloud.triangles.c[0]] - a).z();
    EXPECT_EQ(up > 0, z == "40");
  }
  write_square("oriented.xyz", " 0 0 1");
  const Cloud oriented = mesh({"oriented.xyz"});
  EXPECT_EQ(oriented.triangles.size(), 2U * 81);
  EXPECT_EQ(oriented.normals.size(), 100U) << "normals stay";
  EXPECT_EQ(mesh({"points.xyz", "--radius", "1.5", "--mu", "4", "--max-neighbors", "8",
                  "--max-angle", "100", "--max-normal-angle", "30", "--min-angle", "10"})
                .triangles.size(),
            2U * 81);
}

TEST_F(MeshCommand, SaysWhatIsWrong) {
  write_square("points.xyz");
  folder_.write("two.xyz", "0 0 0\n1 0 0\n");
  folder_.write("depth.png", test::depth_png(2, 2, {1, 1, 1, 1}));
  fails({"points.xyz"}, 2, "--output");
  fails({"-o", "out.ply"}, 2, "CLOUD");
  fails({"points.xyz", "-o", "out.ply", "--method", "magic"}, 2, "magic");
  fails({"points.xyz", "-o", "out.ply", "--method", "grid"}, 2, "points.xyz: the method 'grid'");
  fails({"points.xyz", "-o", "out.ply", "--mu", "0"}, 2, "mu [spacings]: expected 1 to 10");
  fails({"points.xyz", "-o", "out.ply", "--max-grazing", "90"}, 2, "max grazing");
  fails({"points.xyz", "-o", "out.ply", "--radius", "0.5"}, 65, "points.xyz: expected points on");
  fails({"two.xyz", "-o", "out.ply"}, 65, "two.xyz: expected at least 3 points, found 2");
  fails({"depth.png", "-o", "out.ply"}, 65, "depth.png");
  fails({"nowhere.ply", "-o", "out.ply"}, 66, "nowhere.ply");
  fails({"depth.png", "-o", "out.ply", "--camera", "nowhere.json"}, 66, "nowhere.json");
  fails({"points.xyz", "-o", "nowhere/out.ply"}, 73, "nowhere/out.ply");
}

}  // namespace
}  // namespace trivet
