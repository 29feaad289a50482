// OBJ, STL and OFF.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/polygon_mesh.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using test::big;
using test::is_refused;
using test::is_valid;
using test::little;
using Vector = Eigen::Vector3f;
using Indices = Column<std::uint32_t>;

class ReadMesh : public testing::Test {
 protected:
  Result<Cloud> read(std::string_view name, const std::string& bytes,
                     const ReadOptions& options = {}) {
    return read_cloud(folder_.write(name, bytes), options);
  }
  test::TempDir folder_;
};

TEST_F(ReadMesh, GivesTheSameSquareFromEveryFormat) {
  for (const auto& file : test::sample_files()) {
    if (file.name != "quad.obj" && !file.name.ends_with(".stl") && file.name != "normals.off")
      continue;
    SCOPED_TRACE(file.name);
    const auto cloud = read(file.name, file.bytes);
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_TRUE(is_valid(*cloud));
    ASSERT_EQ(cloud->points.size(), 4U);
    EXPECT_EQ(cloud->points[2], Vector(1, 1, 0));
    EXPECT_EQ(cloud->points[3], Vector(0, 1, 0.5F));
    ASSERT_GE(cloud->triangles.size(), 2U);
    EXPECT_EQ(cloud->triangles.a[1], 0U);
    EXPECT_EQ(cloud->triangles.b[1], 2U);
    EXPECT_EQ(cloud->triangles.c[1], 3U);
    EXPECT_EQ(cloud->normals.empty(), file.name.ends_with(".stl"));
  }
}

double area_of(const Cloud& cloud) {
  double sum = 0;
  for (std::size_t t = 0; t < cloud.triangles.size(); ++t) {
    const Eigen::Vector3d a = cloud.points[cloud.triangles.a[t]].cast<double>();
    const Eigen::Vector3d b = cloud.points[cloud.triangles.b[t]].cast<double>();
    const Eigen::Vector3d c = cloud.points[cloud.triangles.c[t]].cast<double>();
    sum += (b - a).cross(c - a).norm() / 2;
  }
  return sum;
}

TEST_F(ReadMesh, GivesConcavePolygonsTheirAreaFromEveryFormat) {
  const test::Outline2d gear = test::gear_outline(24);
  test::Outline2d bore;
  for (int i = 0; i < 24; ++i) {
    const double angle = -2 * std::numbers::pi * i / 24;
    bore.emplace_back(0.5 * std::cos(angle), 0.5 * std::sin(angle));
  }
  const test::Outline2d with_bore = test::bridged(gear, 0, bore);
  for (const test::Outline2d& outline : {gear, with_bore}) {
    double around = 0;
    for (std::size_t i = 0; i < outline.size(); ++i)
      around += (outline[(i + 1) % outline.size()] - outline[i]).norm();
    const double area = 2 * test::shoelace(outline) + 0.4 * around;
    const test::PolygonMesh mesh = test::extruded(outline, 0.4);
    for (const auto& [name, text] :
         {std::pair("gear.obj", mesh.obj()), std::pair("gear.off", mesh.off()),
          std::pair("gear.ply", mesh.ply()), std::pair("faces_first.ply", mesh.ply(true))}) {
      const auto cloud = read(name, text);
      ASSERT_TRUE(cloud) << cloud.error().message;
      EXPECT_NEAR(area_of(*cloud), area, 1e-6 * area) << name;
    }
  }
}

TEST_F(ReadMesh, ObjReadsEveryFormOfCorner) {
  const auto cloud =
      read("a.obj",
           "o part\r\nv 0 0 0 1.0\r\nv 1 0 0 0.5 0.5 0.5\r\nvt 0 0\r\nv 1 1 0\r\nv 0 1 0\r\n"
           "f 1 2 3\r\nf 1/1 2/1 3/1\r\nf -4//-1 -3//-1 -2//-1\r\nf 1/1/1 2/1/1 \\\r\n 3/1/1 4/1/1 "
           "# end\r\n"
           "s off\r\nvn 0 0 1\r\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->triangles.a, (Indices{0, 0, 0, 0, 0}));
  EXPECT_EQ(cloud->triangles.b, (Indices{1, 1, 1, 1, 2}));
  EXPECT_EQ(cloud->triangles.c, (Indices{2, 2, 2, 2, 3}));
  EXPECT_TRUE(cloud->normals.empty())
      << "normals of other indices than their vertices are not used";
}

TEST_F(ReadMesh, ObjReadsVerticesBehindTheirFaces) {
  const auto cloud = read("a.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 0\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->triangles.size(), 1U);
}

TEST_F(ReadMesh, ObjRefusesBrokenIndicesWithTheirLine) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  for (const std::string corner : {"0", "-4", "x", "1.5", "/1", "99999999999999999999",
                                   "4294967297", "-9223372036854775808"}) {
    EXPECT_TRUE(is_refused(read("a.obj", vertices + "f 1 2 " + corner + "\n"), "line 4")) << corner;
  }
  EXPECT_TRUE(is_refused(read("a.obj", vertices + "f 1 2 3\nf 1 2 2147483647\n"),
                         "line 5: the face names vertex 2147483647"));
  EXPECT_TRUE(is_refused(read("a.obj", "v 0 0\n"), "line 1: expected three numbers"));
  EXPECT_TRUE(is_refused(read("a.obj", "just some text\n"),
                         "line 1: expected an element of an OBJ file, v, vn, vt, f or such, found "
                         "\"just\""));
  EXPECT_TRUE(is_refused(read("a.obj", vertices, {.max_points = 2}), "limit of 2"));
}

TEST_F(ReadMesh, ObjJoinsLinesAtABackslashAlsoBehindAWord) {
  const auto cloud = read("a.obj",
                          "v 0 0 0\nv 1 0\\\n 0\nv 1 1 0\n# no line goes on here \\\nv 0 1 0\n"
                          "f 1 2\\\n3\\\r\n4\nl 1 2 \\\n3\ng parts\\\nf 1 \\\n\\\n2 3 # end\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 4U);
  EXPECT_EQ(cloud->triangles.c, (Indices{2, 3, 2}));
}

TEST_F(ReadMesh, ObjLeavesOutWhatIsNoSurfaceAndRefusesWhatItCannotRead) {
  const std::string vertices = "v 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0 # corner\n";
  const auto cloud =
      read("a.obj", vertices +
                        "p 1 2\nl 1 2\ns 1\ncstype bspline\ndeg 3\ncurv 0 1 1 2 3\nparm u 0 1 \\\n"
                        "1\nend\nvt 0 0\nfo 1 2 3\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->triangles.size(), 1U);

  for (const std::string face : {"f", "f 1", "f 1/1 2/1", "f 1 2 # 3"}) {
    EXPECT_TRUE(is_refused(read("a.obj", vertices + face + "\nf 1 2 3\n"),
                           "line 4: expected a face of three or more corners"))
        << face;
  }
  EXPECT_TRUE(is_refused(read("a.obj", vertices + "F 1 2 3\n"), "line 4: expected an element"));
  EXPECT_TRUE(is_refused(read("a.obj", vertices + "surf 0 1 0 1 1 2 3 1\nf 1 2 3\n"), "free-form"));
  EXPECT_TRUE(is_refused(read("a.obj", vertices + "v 1 2 3 v 4 5 6\n"),
                         "line 4: expected numbers behind a vertex, found \"v\""));
  EXPECT_TRUE(is_refused(read("a.obj", vertices + "v 1 2\nv 1 2 3\n"),
                         "line 4: expected three numbers, found the end of the line"));
}

TEST_F(ReadMesh, ReadsTextWithCarriageReturnsAlone) {
  for (const auto& file : test::sample_files()) {
    if (file.name != "quad.obj" && file.name != "text.stl" && file.name != "normals.off") continue;
    SCOPED_TRACE(file.name);
    std::string bytes = file.bytes;
    std::replace(bytes.begin(), bytes.end(), '\n', '\r');
    const auto cloud = read(file.name, bytes), before = read(file.name, file.bytes);
    ASSERT_TRUE(cloud && before);
    EXPECT_EQ(cloud->points.size(), 4U);
    EXPECT_EQ(cloud->triangles.c, before->triangles.c);
  }
}

TEST_F(ReadMesh, StlWeldsCornersAtEqualPlacesInOrderOfAppearance) {
  const auto cloud =
      read("a.stl",
           "solid\nfacet\nvertex 1 0 0\nvertex 0 1 0\nvertex -0 0 0\nendfacet\n"
           "facet\nvertex 0 0 0\nvertex 0 1 0\nvertex nan 0 0\nendfacet\nendsolid\n"
           "solid second\nfacet\nvertex 0 0 1\nvertex 1 0 0\nvertex 0 1 0\nendfacet\nendsolid\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->points.size(), 4U);
  EXPECT_EQ(cloud->points[0], Vector(1, 0, 0));
  EXPECT_EQ(cloud->points[3], Vector(0, 0, 1));
  EXPECT_EQ(cloud->num_invalid, 1U);
  EXPECT_EQ(cloud->triangles.a, (Indices{0, 3}));
  EXPECT_EQ(cloud->triangles.b, (Indices{1, 0}));
}

TEST_F(ReadMesh, StlRefusesSizesThatLie) {
  const std::string preamble(80, ' ');
  EXPECT_TRUE(is_refused(
      read("a.stl", preamble + little(std::uint32_t{0xFFFFFFFF}) + std::string(50, '\0')), "STL"));
  EXPECT_TRUE(is_refused(read("a.stl", preamble + little(std::uint32_t{1}) + std::string(49, '\0')),
                         "STL"));
  EXPECT_TRUE(is_refused(read("a.stl", preamble + little(std::uint32_t{0})), "at least one point"));
  EXPECT_TRUE(is_refused(
      read("a.stl", preamble + little(std::uint32_t{1}) + std::string(50, '\0'), {.max_points = 2}),
      "limit"));
  EXPECT_TRUE(is_refused(
      read("a.stl", "solid a\nfacet\nvertex 0 0 0\nvertex 1 0 0\nendfacet\nendsolid\n"), "line 5"));
  EXPECT_TRUE(is_refused(
      read("a.stl", "solid a\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"),
      "truncated"));
  EXPECT_TRUE(is_refused(read("a.stl", "solid a\nvertex 0 zero 0\nendsolid"),
                         "line 2: expected three numbers"));
}

TEST_F(ReadMesh, StlReportsAnnouncedAndActualBytes) {
  const std::string preamble(80, ' ');
  const auto file = [&](std::uint32_t announced, std::size_t bytes) {
    return preamble + little(announced) + std::string(bytes, '\0');
  };
  EXPECT_TRUE(is_refused(read("a.stl", file(3, 120)),
                         "expected the 234 bytes of a binary STL file of 3 triangles, as it "
                         "announces, found 204 bytes, enough for 2; the file is truncated"));
  EXPECT_TRUE(is_refused(read("a.stl", "solid" + file(1, 120).substr(5)),
                         "announces, found 204 bytes, enough for 2; the file is damaged"));
  EXPECT_TRUE(is_refused(read("a.stl", "solid a\nfacet\nvertex 1 2\n"),
                         "line 3: expected three numbers, found the end of the line"));
}

TEST_F(ReadMesh, StlReadsWhatWritersMakeOfTheFormat) {
  const std::string corners = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
  const std::string capitals =
      "SOLID A\n FACET NORMAL 0 0 1\n  OUTER LOOP\n   VERTEX 0 0 0\n   VERTEX 1 0 0\n"
      "   VERTEX 0 1E0 0\n  ENDLOOP\n ENDFACET\nENDSOLID A\n";
  const std::string colors = "solid a\ncolor 0.5 0.5 0.5\nfacet normal 0 0 1\ncolor 1 0 0\n" +
                             corners + "endfacet\nendsolid\n";
  const std::string no_end = "solid a\nfacet normal nan nan nan\n" + corners + "endfacet\n";
  const std::string one_line =
      "solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop "
      "endfacet";
  const std::string color_header =
      "COLOR=\x7F\x7F\x7F\xFF,MATERIAL=" + std::string(60, '\0') + little(std::uint32_t{1}) +
      little({0.F, 0.F, 1.F}) + little({0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) + "\x1F\x80";
  for (const std::string& bytes : {capitals, colors, no_end, one_line, color_header}) {
    const auto cloud = read("a.stl", bytes);
    ASSERT_TRUE(cloud) << cloud.error().message << bytes;
    EXPECT_EQ(cloud->points.size(), 3U);
    EXPECT_EQ(cloud->triangles.size(), 1U);
  }
  EXPECT_TRUE(is_refused(read("a.stl", "solid\nfacet\n" + corners + "facet\n" + corners),
                         "line 6: expected \"endfacet\", found \"facet\""));
  EXPECT_TRUE(is_refused(read("a.stl", "solid\nfacet\nvertex 0 0 0 1\n"), "line 3"));
}

TEST_F(ReadMesh, OffReadsNumbersOnAnyLines) {
  const std::string square = "0 0 0 1 0 0\n1 1 0 0 1 0\n";
  const std::vector<std::string> files{
      "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3\n0 1\n2 255 0 0\n3 0 2\n3\n",
      "OFF 4 2 0 " + square + "3 0 1 2 3 0 2 3\n",
      "4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
      "# no keyword\n4\n2\n0\n" + square + "3 0 1 2\n3 0 2 3",
      "OFF\n4\n2\n0\n0\n0\n0\n1\n0\n0\n1\n1\n0\n0\n1\n0\n3\n0\n1\n2\n3\n0\n2\n3\n",
      "COFF 4 2 0\n0 0 0 1 0 0 1 1 0 0 1 0 0 1\n1 1 0 1 0 0 1 0 1 0 1 0 0 1\n3 0 1 2 3 0 2 3\n",
      "STCNOFF 4 2 0 0 0 0 0 0 1 9 9 9 9 5 5 1 0 0 0 0 1 9 9 9 9 5 5 1 1 0 0 0 1 9 9 9 9 5 5\n"
      "0 1 0 0 0 1 9 9 9 9 5 5 3 0 1 2 3 0 2 3"};
  for (const std::string& file : files) {
    const auto cloud = read("a.off", file);
    ASSERT_TRUE(cloud) << cloud.error().message << "\n" << file;
    ASSERT_EQ(cloud->points.size(), 4U) << file;
    EXPECT_EQ(cloud->points[2], Vector(1, 1, 0)) << file;
    EXPECT_EQ(cloud->points[3], Vector(0, 1, 0)) << file;
    EXPECT_EQ(cloud->triangles.b, (Indices{1, 2})) << file;
    EXPECT_EQ(cloud->triangles.c, (Indices{2, 3})) << file;
    EXPECT_EQ(cloud->normals.size(), file.starts_with("STCNOFF") ? 4U : 0U);
  }
}

TEST_F(ReadMesh, OffReadsTheBinaryForm) {
  const auto integers = [](std::initializer_list<std::int32_t> values) {
    std::string bytes;
    for (const std::int32_t value : values) bytes += big(value);
    return bytes;
  };
  const auto floats = [](std::initializer_list<float> values) {
    std::string bytes;
    for (const float value : values) bytes += big(value);
    return bytes;
  };
  const std::string faces =
      integers({3, 0, 1, 2, 0, 4, 0, 1, 2, 3, 3}) + floats({1, 0, 0});  // one with a color
  const std::string plain =
      "OFF BINARY\n" + integers({4, 2, 0}) + floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + faces;
  const std::string colored = "CNOFF BINARY\r\n" + integers({4, 2, 0}) +
                              floats({0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1, 1,
                                      1, 1, 0, 0, 0, 1, 1, 1, 1, 1, 0, 1, 0, 0, 0, 1, 1, 1, 1, 1}) +
                              faces;
  for (const std::string& file : {plain, colored}) {
    const auto cloud = read("a.off", file);
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_EQ(cloud->points[2], Vector(1, 1, 0));
    EXPECT_EQ(cloud->triangles.c, (Indices{2, 2, 3}));
    EXPECT_EQ(cloud->normals.size(), file == plain ? 0U : 4U);
  }
  for (std::size_t size = 11; size < plain.size(); ++size)
    EXPECT_TRUE(is_refused(read("a.off", plain.substr(0, size)), "expected")) << size;
  EXPECT_TRUE(is_refused(read("a.off", plain + "more"), "byte 127: expected the end of the file"));
  std::string outside = plain;
  outside[11 + 12 + 48 + 7] = 9;
  EXPECT_TRUE(
      is_refused(read("a.off", outside), "byte 75: expected the index of a vertex below 4"));
}

TEST_F(ReadMesh, OffReadsColorsCommentsAndGluedCounts) {
  const std::string body =
      "0 0 0 255 0 0\n1 0 0 0.5\n\n1 1 0 # corner\n0 1 0\n4 0 1 2 3 10 20 30\n2 0 1\n";
  for (const std::string header :
       {"COFF\n4 2 0\n", "OFF4 2 0\n", "# made by hand\nOFF\n# counts\n4 2 # faces\n0\n",
        "STOFF 4 2 0\n"}) {
    const auto cloud = read("a.off", header + body);
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_EQ(cloud->points.size(), 4U);
    EXPECT_EQ(cloud->triangles.c, (Indices{2, 3})) << header;
    EXPECT_TRUE(cloud->normals.empty());
  }
}

TEST_F(ReadMesh, OffRefusesCountsThatLie) {
  EXPECT_TRUE(is_refused(read("a.off", "OFF\n1152921504606846976 1 0\n0 0 0\n"), "limit"));
  EXPECT_TRUE(is_refused(read("a.off", "OFF\n1000 1 0\n0 0 0\n"), "truncated"));
  EXPECT_TRUE(is_refused(read("a.off", "OFF\n1 1152921504606846976 0\n0 0 0\n"), "truncated"));
  EXPECT_TRUE(is_refused(read("a.off", "OFF\n-1 1 0\n0 0 0\n"), "numbers of vertices"));
  EXPECT_TRUE(is_refused(read("a.off", "OFF BINARY\n" + std::string(40, '\1')), "truncated"));
  EXPECT_TRUE(is_refused(read("a.off", "OFF BINARY\n" + std::string(11, '\1')),
                         "byte 19: expected the numbers of vertices, faces and edges"));
  const std::string vertices = "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n";
  EXPECT_TRUE(
      is_refused(read("a.off", vertices + "3 0 1\n"),
                 "line 6: expected the index of a vertex below 3, found the end of the line"));
  EXPECT_TRUE(is_refused(read("a.off", vertices), "found the end of the file"));
  EXPECT_TRUE(is_refused(read("a.off", vertices + "3 0 1 2\n3 0 2 1\n"),
                         "line 7: expected the end of the file behind the last face, found \"3\""));
  EXPECT_TRUE(
      is_refused(read("a.off", vertices + "3 0 1 2 red\n"), "line 6: expected at most four"));
  EXPECT_TRUE(is_refused(read("a.off", "OFF\nthree 1 0\n"),
                         "line 2: expected the numbers of vertices, faces and edges, found "
                         "\"three\""));
  EXPECT_TRUE(is_refused(read("a.off", "4OFF\n1 0 0\n0 0 0 0\n"), "begins with OFF"));
  EXPECT_TRUE(is_refused(read("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n"),
                         "line 6: expected the index of a vertex below 3"));
  EXPECT_TRUE(
      is_refused(read("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n9999999999 0 1 2\n"), "below 3"));
  EXPECT_TRUE(is_refused(read("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 nan!\n3 0 1 2\n"), "line 5"));
}

}  // namespace
}  // namespace trivet
