// Meshes far from zero, as in maps, lose no significant digit and keep their faces.
#include <gtest/gtest.h>

#include <string>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;

TEST(FarMesh, KeepsMillimetersInEveryTextFormat) {
  const Vector3d corners[] = {{512345.123, 5403210.987, 431.001},
                              {512348.124, 5403210.988, 431.002},
                              {512345.125, 5403212.989, 432.503}};
  const std::string a = "512345.123 5403210.987 431.001", b = "512348.124 5403210.988 431.002",
                    c = "512345.125 5403212.989 432.503";
  const test::TempDir folder;
  const auto obj = folder.write("far.obj", "v " + a + "\nv " + b + "\nv " + c + "\nf 1 2 3\n");
  const auto off =
      folder.write("far.off", "OFF\n3 1 0\n" + a + "\n" + b + "\n" + c + "\n3 0 1 2\n");
  const auto stl =
      folder.write("far.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex " + a + "\nvertex " +
                                  b + "\nvertex " + c + "\nendloop\nendfacet\nendsolid\n");
  for (const auto& file : {obj, off, stl}) {
    const auto cloud = read_cloud(file);
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_EQ(cloud->points.size(), 3U);
    EXPECT_EQ(cloud->triangles.size(), 1U);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d p = cloud->points[i].cast<double>() + cloud->offset;
      EXPECT_LT((p - corners[i]).cwiseAbs().maxCoeff(), 2.5e-7) << file << ", point " << i;
    }
    EXPECT_TRUE(test::is_refused(read_cloud(file, {.keep_origin = true}), "subtract about"));
  }
}

}  // namespace
}  // namespace trivet
