#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::big;
using test::is_refused;
using test::is_valid;
using test::little;
using Vector = Eigen::Vector3f;

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

class ReadPly : public testing::Test {
 protected:
  Result<Cloud> read(const std::string& bytes, const ReadOptions& options = {}) {
    return read_cloud(folder_.write("cloud.ply", bytes), options);
  }
  test::TempDir folder_;
};

TEST_F(ReadPly, GivesTheSameCloudInEveryEncoding) {
  for (const auto& file : test::sample_files()) {
    if (file.name != "ascii.ply" && file.name != "little.ply" && file.name != "big.ply") continue;
    SCOPED_TRACE(file.name);
    const auto cloud = read(file.bytes);
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_TRUE(is_valid(*cloud));
    ASSERT_EQ(cloud->points.size(), 4U);
    EXPECT_EQ(cloud->points[3], Vector(0, 1, 0.5F));
    ASSERT_EQ(cloud->triangles.size(), 2U);
    EXPECT_EQ(cloud->triangles.c[1], 3U);
    EXPECT_TRUE(cloud->normals.empty());
    EXPECT_FALSE(cloud->grid || cloud->camera || cloud->viewpoint);
  }
}

TEST_F(ReadPly, ReadsAnyPropertyOrderAndTypeAndUnknownProperties) {
  const auto cloud = read(
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar red\nproperty double "
      "z\n"
      "property list uint8 float32 weights\nproperty int16 y\nproperty float64 nx\nproperty char "
      "ny\n"
      "property uint x\nproperty ushort nz\nend_header\n" +
      little(std::uint8_t{9}) + little(-2.5) + little(std::uint8_t{2}) + little({7.0F, 8.0F}) +
      little(std::int16_t{-300}) + little(0.5) + little(std::int8_t{-1}) +
      little(std::uint32_t{70000}) + little(std::uint16_t{3}));
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points[0], Vector(70000, -300, -2.5F));
  ASSERT_EQ(cloud->normals.size(), 1U);
  EXPECT_EQ(cloud->normals[0], Vector(0.5F, -1, 3));
}

TEST_F(ReadPly, ReadsWindowsLineEndsCommentsAndForeignElements) {
  const auto cloud = read(
      "ply\r\ncomment format binary\r\nformat ascii 1.0\r\nobj_info anything at all\r\nelement "
      "material 2\r\n"
      "property float shine\r\nproperty list int float spectrum\r\nelement nothing "
      "1000000000000000000\r\n"
      "element vertex 2\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n"
      "element edge 1\r\nproperty int vertex1\r\nproperty int vertex2\r\nend_header\r\n"
      "0.5 3 1 2 3\r\n0.1 0\r\n1 2 3\r\n+4e0 -5. .6e1\r\n0 1\r\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->points.size(), 2U);
  EXPECT_EQ(cloud->points[1], Vector(4, -5, 6));
}

TEST_F(ReadPly, SplitsPolygonsIntoFansAndLeavesOutLines) {
  const auto cloud =
      read("ply\nformat ascii 1.0\nelement vertex 5\n" + kXyz +
           "element face 3\nproperty uchar red\nproperty list uchar int vertex_index\n"
           "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n9 5 0 1 2 3 4\n9 2 0 1\n9 0\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->triangles.size(), 3U);
  for (std::uint32_t t = 0; t < 3; ++t) {
    EXPECT_EQ(cloud->triangles.a[t], 0U);
    EXPECT_EQ(cloud->triangles.b[t], t + 1);
    EXPECT_EQ(cloud->triangles.c[t], t + 2);
  }
}

TEST_F(ReadPly, KeepsTheWindingOfTriangleStrips) {
  // Triangle strips that alternate in direction over a flat grid: every triangle must face +z.
  const auto cloud =
      read("ply\nformat ascii 1.0\nelement vertex 6\n" + kXyz +
           "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
           "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n12 1 0 3 2 5 4 -1 1 0 3 3 3\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->triangles.size(), 5U);  // the last two of the second strip repeat a vertex
  for (std::size_t t = 0; t < 5; ++t) {
    const Vector a = cloud->points[cloud->triangles.a[t]], b = cloud->points[cloud->triangles.b[t]];
    const Vector c = cloud->points[cloud->triangles.c[t]];
    EXPECT_EQ((b - a).cross(c - a), Vector(0, 0, 1)) << "triangle " << t;
  }
}

TEST_F(ReadPly, FillsTheGridOfARangeScan) {
  for (const auto& file : test::sample_files()) {
    if (file.name != "grid.ply") continue;
    const auto cloud = read(file.bytes);
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_TRUE(cloud->grid);
    EXPECT_EQ(cloud->grid->width, 3U);
    EXPECT_EQ(cloud->grid->height, 2U);
    EXPECT_EQ(cloud->grid->point_index, (Column<std::int32_t>{0, -1, 1, 2, -1, 3}));
  }
}

TEST_F(ReadPly, DropsPointsThatAreNotFiniteWithTheirTrianglesAndPixels) {
  const auto cloud = read(
      "ply\nformat ascii 1.0\nobj_info num_cols 2\nobj_info num_rows 2\nelement vertex 4\n" + kXyz +
      "property float nx\nproperty float ny\nproperty float nz\n"
      "element face 2\nproperty list uchar int vertex_indices\n"
      "element range_grid 4\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 0 0 1\n1 nan 0 0 0 2\n1 1 0 0 0 3\n0 1 0 nan 0 4\n3 0 1 2\n3 0 2 3\n1 0\n1 1\n1 2\n1 "
      "3\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_TRUE(is_valid(*cloud));
  EXPECT_EQ(cloud->num_invalid, 1U);
  ASSERT_EQ(cloud->points.size(), 3U);
  EXPECT_EQ(cloud->normals[1], Vector(0, 0, 3));
  EXPECT_EQ(cloud->normals[2], Vector(0, 0, 0)) << "a normal that is not finite is none";
  ASSERT_EQ(cloud->triangles.size(), 1U);
  EXPECT_EQ(cloud->triangles.b[0], 1U);
  EXPECT_EQ(cloud->grid->point_index, (Column<std::int32_t>{0, -1, 1, 2}));
}

TEST_F(ReadPly, ReadsTheViewpointOfACameraElementUnlessItIsZero) {
  const std::string header = "ply\nformat ascii 1.0\nelement vertex 1\n" + kXyz +
                             "element camera 1\nproperty float view_px\nproperty float view_py\n"
                             "property float view_pz\nproperty int viewportx\nend_header\n1 2 3\n";
  const auto placed = read(header + "4 5 6 640\n"), unknown = read(header + "0 0 0 640\n");
  ASSERT_TRUE(placed && unknown);
  EXPECT_EQ(placed->viewpoint, Vector(4, 5, 6));
  EXPECT_FALSE(unknown->viewpoint);
}

TEST_F(ReadPly, NamesTheLineAndTheWordThatIsWrong) {
  const std::string header = "ply\nformat ascii 1.0\nelement vertex 2\n" + kXyz + "end_header\n";
  EXPECT_TRUE(is_refused(read(header + "0 0 0\n1 1 abc\n"),
                         "line 9: \"vertex\" 1 of 2: expected a number, found \"abc\""));
  EXPECT_TRUE(
      is_refused(read(header + "0 0 0\n10 100\n"),
                 "line 9: \"vertex\" 1 of 2: expected a number, found the end of the line"));
  EXPECT_TRUE(is_refused(read(header + "0 0 0\n10 100"), "found the end of the file"));
  EXPECT_TRUE(is_refused(read("ply\nformat ascii 1.0\nelephant\n"), "line 3"));
  EXPECT_TRUE(is_refused(read("ply\nformat ascii 2\xFF\x1B[31m\n"), "end_header"));
  EXPECT_TRUE(is_refused(read("PLY\n"), "begins with \"ply\""));
}

TEST_F(ReadPly, ReadsOneRowALineInText) {
  const std::string header = "ply\nformat ascii 1.0\nelement vertex 3\n" + kXyz;
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_TRUE(is_refused(read(header + "end_header\n0 0 0 9\n1 0 0 9\n0 1 0 9\n"),
                         "line 8: \"vertex\" 0 of 3: expected the end of the line"));
  EXPECT_TRUE(is_refused(read(header + faces + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255\n"),
                         "line 13: \"face\" 0 of 1: expected the end of the line"));
  EXPECT_TRUE(
      is_refused(read(header + "end_header\n0 0\n0 1 0\n0 0 1 0\n0 0 0\n"),
                 "line 8: \"vertex\" 0 of 3: expected a number, found the end of the line"));
  EXPECT_TRUE(is_refused(read(header + "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"),
                         "line 11: expected the end of the file"));
  EXPECT_TRUE(read(header + faces + "\n0 0 0 \n\n1 0 0\r\n0 1 0\n3 0 1 2\n \n"));
}

TEST_F(ReadPly, ReadsFacesUnderAnyNameThatWritersGiveTheirCorners) {
  const auto named = [&](const std::string& name) {
    return read("ply\nformat ascii 1.0\nelement vertex 3\n" + kXyz + "element face 1\n" +
                "property uchar red\nproperty list uchar int " + name +
                "\nend_header\n0 0 0\n1 0 0\n0 1 0\n9 3 0 1 2\n");
  };
  for (const char* name : {"vertex_index", "vertex_indices", "vertex_indexes", "vertices"}) {
    const auto cloud = named(name);
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_EQ(cloud->triangles.size(), 1U) << name;
  }
  EXPECT_TRUE(
      is_refused(named("corners"), "in the element \"face\", found \"red\", list \"corners\""));
}

TEST_F(ReadPly, ReadsFacesBeforeTheirVertices) {
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string ascii = "ply\nformat ascii 1.0\n" + faces + "element vertex 3\n" + kXyz;
  const auto text = read(ascii + "end_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n");
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(text->triangles.c, (Column<std::uint32_t>{2}));
  EXPECT_EQ(text->points[2], Vector(0, 1, 0));
  const auto binary = read("ply\nformat binary_little_endian 1.0\n" + faces + "element vertex 3\n" +
                           kXyz + "end_header\n" + little(std::uint8_t{3}) + little({0, 1, 2}) +
                           little({0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}));
  ASSERT_TRUE(binary) << binary.error().message;
  EXPECT_EQ(binary->triangles.c, (Column<std::uint32_t>{2}));
  EXPECT_TRUE(
      is_refused(read(ascii + "end_header\n3 0 1 3\n0 0 0\n1 0 0\n0 1 0\n"), "names vertex 3"));
}

TEST_F(ReadPly, NamesTheByteThatIsWrong) {
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + kXyz +
                             "element face 1\nproperty list uchar int vertices\nend_header\n";
  const std::string bytes = header + little({0.F, 0.F, 0.F}) + little(std::uint8_t{1}) + little(7);
  EXPECT_TRUE(is_refused(read(bytes), "byte " + std::to_string(bytes.size()) + ": \"face\" 0"));
}

TEST_F(ReadPly, TreatsARowOfPixelsAsNoGrid) {
  const auto cloud = read(
      "ply\nformat ascii 1.0\nobj_info num_cols 1\nobj_info num_rows 2\n"
      "element vertex 2\n" +
      kXyz +
      "element range_grid 2\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0\n1 0 0\n1 0\n1 1\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_FALSE(cloud->grid);
}

TEST_F(ReadPly, RefusesHeadersThatLie) {
  const std::string ascii = "ply\nformat ascii 1.0\n",
                    binary = "ply\nformat binary_little_endian 1.0\n";
  const std::string body = "end_header\n" + std::string(200, '0');
  for (const std::string count :
       {"1152921504606846976", "9223372036854775807", "100000", "99999999"}) {
    for (const std::string& format : {ascii, binary}) {
      EXPECT_TRUE(
          is_refused(read(format + "element vertex " + count + "\n" + kXyz + body), "truncated"))
          << count;
      EXPECT_TRUE(is_refused(
          read(format + "element face " + count + "\nproperty list uchar int vertex_indices\n" +
               "element vertex 1\n" + kXyz + body),
          "truncated"))
          << count;
    }
  }
  for (const std::string count : {"-1", "1e3", "99999999999999999999999", "", "0x10", "nan"}) {
    EXPECT_TRUE(is_refused(read(ascii + "element vertex " + count + "\n" + kXyz + body),
                           "element NAME COUNT"));
  }
  EXPECT_TRUE(is_refused(read(ascii + kXyz + body), "below an element"));
  EXPECT_TRUE(
      is_refused(read(ascii + "element vertex 1\nproperty float x\n" + body), "x, y and z"));
  EXPECT_TRUE(is_refused(read(ascii + "element vertex 1\nelement vertex 1\n" + body), "twice"));
  EXPECT_TRUE(is_refused(read(ascii + "element vertex 1\nproperty list double int x\n" + body),
                         "property"));
  EXPECT_TRUE(is_refused(read(ascii + "element face 0\n" + body), "element vertex"));
  EXPECT_TRUE(is_refused(read("ply\nelement vertex 1\n" + kXyz + body), "format"));
  EXPECT_TRUE(
      is_refused(read(ascii + "comment " + std::string(70000, 'x') + "\n" + body), "65536"));
  EXPECT_TRUE(is_refused(read(ascii + "element vertex 0\n" + kXyz + "end_header\n\n"),
                         "at least one point"));
}

TEST_F(ReadPly, RefusesListsThatLie) {
  const std::string vertex = "element vertex 1\n" + kXyz + "element face 1\nproperty list ";
  const std::string ascii =
      "ply\nformat ascii 1.0\n" + vertex + "int int vertex_indices\nend_header\n0 0 0\n";
  EXPECT_TRUE(is_refused(read(ascii + "2000000000 0 0 0\n"), "longer than the file"));
  EXPECT_TRUE(is_refused(read(ascii + "-3 0 0 0\n"), "longer than the file"));
  EXPECT_TRUE(is_refused(read(ascii + "2.5 0 0 0\n"), "longer than the file"));
  EXPECT_TRUE(is_refused(read(ascii + "3 0 0 1\n"), "names vertex 1"));
  EXPECT_TRUE(is_refused(read(ascii + "3 0 0 -1\n"), "names vertex -1"));
  EXPECT_TRUE(is_refused(read(ascii + "3 0 0 nan\n"), "names vertex nan"));
  EXPECT_TRUE(
      is_refused(read("ply\nformat binary_little_endian 1.0\n" + vertex +
                      "uchar int vertex_indices\nend_header\n" + little({0.F, 0.F, 0.F}) + "\xFF"),
                 "longer than the file"));
  EXPECT_TRUE(is_refused(
      read("ply\nformat ascii 1.0\nobj_info num_cols 4294967296\nobj_info num_rows 4294967297\n"
           "element vertex 1\n" +
           kXyz +
           "element range_grid 2\nproperty list uchar int vertex_indices\nend_header\n0 0 "
           "0\n0\n0\n"),
      "num_cols"));
  EXPECT_TRUE(is_refused(read("ply\nformat ascii 1.0\nobj_info num_cols 2\nobj_info num_rows 1\n"
                              "element vertex 1\n" +
                              kXyz +
                              "element range_grid 2\nproperty list uchar int "
                              "vertex_indices\nend_header\n0 0 0\n2 0 0\n0\n"),
                         "too long"));
}

TEST_F(ReadPly, RefusesMorePointsThanAllowed) {
  const std::string file =
      "ply\nformat ascii 1.0\nelement vertex 2\n" + kXyz + "end_header\n0 0 0\n1 1 1\n";
  EXPECT_TRUE(is_refused(read(file, {.max_points = 1}), "limit of 1"));
  EXPECT_TRUE(is_refused(read(file, {.max_file_bytes = 10}), "limit of 10"));
  EXPECT_TRUE(read(file, {.max_points = 2}));
}

TEST_F(ReadPly, RefusesCoordinatesThatFloatCannotHold) {
  const std::string header = "ply\nformat ascii 1.0\nelement vertex 2\n" + kXyz + "end_header\n";
  EXPECT_TRUE(is_refused(read(header + "0 0 0\n1.1e7 0 0\n"), "up to 1e+07"));
  EXPECT_TRUE(is_refused(read(header + "0 0 0\n1e300 0 0\n"), "up to 1e+07"));
  EXPECT_TRUE(is_refused(read(header + "500000 4000000 20\n500000 4000000 20\n"), "subtract"));
  EXPECT_TRUE(is_refused(read(header + "nan 0 0\n0 inf 0\n"), "none is finite"));
  const auto far = read(header + "100000 0 0\n100010 0 0\n");
  EXPECT_TRUE(far) << far.error().message;
}

}  // namespace
}  // namespace trivet
