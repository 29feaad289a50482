// Coordinates far from zero, as in maps, lose no significant digit in any format.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "storage/formats/positions.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/random.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;
using test::is_refused;
using test::little;

/// Corners of a part 3 m wide, given to the millimeter, in meters east and north of a map's origin.
const std::vector<Vector3d> kTriangleCorners{{512345.123, 5403210.987, 431.001},
                                             {512348.124, 5403210.988, 431.002},
                                             {512345.125, 5403212.989, 432.503},
                                             {512346.626, 5403211.49, 430.004}};
const Vector3d kSensor{512346.5, 5403211.5, 437.25};

std::string rows() {
  std::string text;
  for (const Vector3d& p : kTriangleCorners) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  return text;
}
std::string doubles() {
  std::string bytes;
  for (const Vector3d& p : kTriangleCorners) bytes += little({p.x(), p.y(), p.z()});
  return bytes;
}

const std::string kPlyVertices =
    "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n";
const std::string kPlyCamera =
    "element camera 1\nproperty double view_px\nproperty double view_py\nproperty double view_pz\n";
const std::string kPcd =
    "FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\n"
    "VIEWPOINT 512346.5 5403211.5 437.25 1 0 0 0\nPOINTS 4\n";

struct File {
  const char* name;
  std::string bytes;
  bool has_viewpoint;
};
std::vector<File> far_files() {
  const std::string sensor = fmt::format("{} {} {}\n", kSensor.x(), kSensor.y(), kSensor.z());
  return {{"far.xyz", rows(), false},
          {"far.csv",
           "x,y,z\n" +
               [] {
                 std::string text = rows();
                 for (char& c : text) c = c == ' ' ? ',' : c;
                 return text;
               }(),
           false},
          {"text.ply",
           "ply\nformat ascii 1.0\n" + kPlyCamera + kPlyVertices + "end_header\n" + sensor + rows(),
           true},
          {"binary.ply",
           "ply\nformat binary_little_endian 1.0\n" + kPlyVertices + kPlyCamera + "end_header\n" +
               doubles() + little({kSensor.x(), kSensor.y(), kSensor.z()}),
           true},
          {"text.pcd", kPcd + "DATA ascii\n" + rows(), true},
          {"binary.pcd", kPcd + "DATA binary\n" + doubles(), true}};
}

class FarCloud : public testing::Test {
 protected:
  Result<Cloud> read(const std::string& name, const std::string& bytes,
                     const ReadOptions& options = {}) {
    return read_cloud(folder_.write(name, bytes), options);
  }
  test::TempDir folder_;
};

TEST_F(FarCloud, KeepsMillimetersInEveryFormat) {
  for (const File& file : far_files()) {
    const auto cloud = read(file.name, file.bytes);
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_EQ(cloud->points.size(), kTriangleCorners.size());
    for (std::size_t i = 0; i < kTriangleCorners.size(); ++i) {
      const Vector3d p = cloud->points[i].cast<double>() + cloud->offset;
      // Within 6 m of the offset, floats round by at most 2.4e-7.
      EXPECT_LT((p - kTriangleCorners[i]).cwiseAbs().maxCoeff(), 2.5e-7)
          << file.name << ", point " << i;
    }
    ASSERT_EQ(cloud->viewpoint.has_value(), file.has_viewpoint) << file.name;
    if (file.has_viewpoint) {
      EXPECT_EQ(cloud->viewpoint->cast<double>() + cloud->offset, kSensor) << file.name;
    }
  }
}

TEST_F(FarCloud, IsWrittenBackInItsOwnFrame) {
  for (const File& file : far_files()) {
    const auto cloud = read(file.name, file.bytes);
    ASSERT_TRUE(cloud && write_ply(folder_ / "out.ply", *cloud));
    const std::string bytes = encode_ply(*cloud);
    EXPECT_NE(bytes.find("property double x"), std::string::npos);
    const auto again = read_cloud(folder_ / "out.ply");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->offset, cloud->offset);
    EXPECT_TRUE(test::same_bits(again->points, cloud->points)) << file.name;
  }
}

TEST_F(FarCloud, IsNotMovedUnlessFloatsAreTooCoarse) {
  const auto square = [](double x) {
    return fmt::format("{} 0 0\n{} 0 0\n{} 1 0.5\n", x, x + 1, x);
  };
  for (const double x : {0.0, -1.0, 1.0, 100.0, -127.0, 127.0 - 1}) {
    const auto cloud = read("near.xyz", square(x));
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_TRUE(cloud->offset.isZero(0)) << x;
    EXPECT_EQ(cloud->points[0].x(), static_cast<float>(x));
    EXPECT_FALSE(std::signbit(cloud->points[0].y())) << "to the bit";
  }
  for (const double x : {200.0, -200.0, 4e6}) {
    const auto cloud = read("far.xyz", square(x));
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_NEAR(cloud->offset.x(), x + 0.5, 0.5);
    EXPECT_EQ(cloud->offset.y(), 0) << "only where it is far";
  }
  const auto point = read("point.xyz", "500 0 0\n");
  ASSERT_TRUE(point);
  EXPECT_TRUE(point->offset.isZero(0)) << "a point has no extent to be compared with";
}

TEST_F(FarCloud, IsNoModel) {
  const ReadOptions model{.keep_origin = true};
  for (const File& file : far_files()) {
    EXPECT_TRUE(is_refused(read(file.name, file.bytes, model),
                           "subtract about (512347, 5403212, 431) from all coordinates"));
  }
  const auto near = read("part.xyz", "500.5 0 0\n501.5 0 0\n500.5 1 0\n", model);
  ASSERT_TRUE(near) << near.error().message;
  EXPECT_TRUE(near->offset.isZero(0));
  EXPECT_EQ(near->points[0].x(), 500.5F);
}

TEST_F(FarCloud, EndsWhereNoMapReaches) {
  EXPECT_TRUE(is_refused(read("mars.xyz", "1e11 0 0\n100000000001 0 0\n1e11 1 0\n"),
                         "up to 1e+10, found some near (1e+11, 0, 0)"));
  EXPECT_TRUE(read("earth.xyz", "5403210987 0 0\n5403213987 0 0\n5403210987 1000 0\n"));
}

}  // namespace
}  // namespace trivet
