#include "storage/formats/used_vertices.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "storage/formats/memory_cloud.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"

namespace trivet {
namespace {

/// A tetrahedron, optionally with a distant fifth vertex and a triangle without area that uses it.
struct Tetrahedron {
  bool far_vertex = false, flat_triangle = false;

  std::vector<float> coordinates() const {
    std::vector<float> all{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (far_vertex) all.insert(all.end(), {10, 10, 10});
    return all;
  }
  std::vector<std::uint32_t> indices() const {
    std::vector<std::uint32_t> all{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    if (flat_triangle) all.insert(all.end(), {0, 4, 4});
    return all;
  }
  std::size_t num_points() const { return far_vertex ? 5 : 4; }
  std::size_t num_triangles() const { return flat_triangle ? 5 : 4; }

  std::string lines(const char* point, const char* triangle, std::uint32_t first) const {
    std::string text;
    const auto p = coordinates();
    const auto t = indices();
    for (std::size_t i = 0; i < p.size(); i += 3)
      text += fmt::format("{}{} {} {}\n", point, p[i], p[i + 1], p[i + 2]);
    for (std::size_t i = 0; i < t.size(); i += 3) {
      text +=
          fmt::format("{}{} {} {}\n", triangle, t[i] + first, t[i + 1] + first, t[i + 2] + first);
    }
    return text;
  }
  std::string ply() const {
    return fmt::format(
               "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
               "property float z\nelement face {}\nproperty list uchar int vertex_indices\n"
               "end_header\n",
               num_points(), num_triangles()) +
           lines("", "3 ", 0);
  }
  std::string obj() const { return lines("v ", "f ", 1); }
  std::string off() const {
    return fmt::format("OFF\n{} {} 0\n", num_points(), num_triangles()) + lines("", "3 ", 0);
  }
  std::string stl() const {  // its vertices are all corners of triangles
    std::string text = "solid a\n";
    const auto p = coordinates();
    const auto t = indices();
    for (std::size_t i = 0; i < t.size(); i += 3) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (std::size_t k = i; k < i + 3; ++k) {
        text += fmt::format("vertex {} {} {}\n", p[3 * t[k]], p[3 * t[k] + 1], p[3 * t[k] + 2]);
      }
      text += "endloop\nendfacet\n";
    }
    return text + "endsolid a\n";
  }
  std::string glb() const {
    std::string buffer;
    for (const float v : coordinates()) buffer += test::little(v);
    const std::size_t faces_at = buffer.size();
    for (const std::uint32_t i : indices()) buffer += test::little(i);
    const std::string document = fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],)"
        R"("nodes":[{{"mesh":0}}],)"
        R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],)"
        R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}},)"
        R"({{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}],)"
        R"("bufferViews":[{{"buffer":0,"byteLength":{}}},)"
        R"({{"buffer":0,"byteOffset":{},"byteLength":{}}}],"buffers":[{{"byteLength":{}}}]}})",
        num_points(), indices().size(), faces_at, faces_at, buffer.size() - faces_at,
        buffer.size());
    return test::glb_file(document, buffer);
  }
};

Result<Cloud> read_as(const std::string& file, const std::string& name, bool as_model) {
  const ReadOptions options{.keep_origin = as_model};
  return read_cloud({reinterpret_cast<const std::byte*>(file.data()), file.size()}, name, options);
}

struct MeshFormat {
  std::string name;
  std::string (Tetrahedron::*file)() const;
};
const std::vector<MeshFormat> kMeshFormats{{"a.ply", &Tetrahedron::ply},
                                           {"a.obj", &Tetrahedron::obj},
                                           {"a.off", &Tetrahedron::off},
                                           {"a.stl", &Tetrahedron::stl},
                                           {"a.glb", &Tetrahedron::glb}};

void expect_tetrahedron(const Result<Cloud>& cloud, const std::string& name) {
  ASSERT_TRUE(cloud) << name << ": " << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 4U) << name;
  EXPECT_EQ(cloud->triangles.size(), 4U) << name;
  for (std::size_t i = 0; i < cloud->points.size(); ++i)
    EXPECT_LE(cloud->points[i].maxCoeff(), 1) << name;
}

TEST(UsedVertices, LeaveOutOfModelsOfEveryFormatWhatNoFaceWithAnAreaUses) {
  for (const auto& [name, file] : kMeshFormats) {
    const bool has_vertices = name != "a.stl";
    const Result<Cloud> plain = read_as((Tetrahedron{}.*file)(), name, true);
    expect_tetrahedron(plain, name);
    EXPECT_EQ(plain->num_unused, 0U) << name;
    EXPECT_EQ(plain->num_without_area, 0U) << name;

    if (has_vertices) {
      const Result<Cloud> far = read_as((Tetrahedron{true, false}.*file)(), name, true);
      expect_tetrahedron(far, name);
      // The glTF reader keeps no vertex without an index.
      EXPECT_EQ(far->num_unused, name == "a.glb" ? 0U : 1U) << name;
    }
    const Result<Cloud> flat = read_as((Tetrahedron{true, true}.*file)(), name, true);
    expect_tetrahedron(flat, name);
    EXPECT_EQ(flat->num_unused, 1U) << name;
    EXPECT_EQ(flat->num_without_area, 1U) << name;
  }
}

TEST(UsedVertices, LeaveOutOfModelsInMemoryWhatNoFaceWithAnAreaUses) {
  const Tetrahedron mesh{true, true};
  const std::vector<float> points = mesh.coordinates();
  const std::vector<std::uint32_t> triangles = mesh.indices();
  MemoryCloudOptions options{.name = "a", .keep_origin = true};
  options.triangles = ArrayView::packed(triangles.data(), 5, 3);
  expect_tetrahedron(cloud_from_points(ArrayView::packed(points.data(), 5, 3), options), "memory");
}

TEST(UsedVertices, AreAllPointsOfAScan) {
  const Result<Cloud> scan = read_as(Tetrahedron{true, true}.ply(), "a.ply", false);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->points.size(), 5U);
  EXPECT_EQ(scan->num_unused, 0U);
}

// Programs that only display meshes write the points of a cloud as degenerate faces.
TEST(UsedVertices, AreAllPointsWhereNoFaceHasAnArea) {
  const Result<Cloud> cloud =
      read_as("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 1 1\nf 2 2 2\nf 3 3 3\n", "a.obj", true);
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->points.size(), 3U);
  EXPECT_TRUE(cloud->triangles.empty());
  EXPECT_EQ(cloud->num_without_area, 3U);
}

TEST(UsedVertices, HaveAnAreaIfFloatsDistinguishItFromZero) {
  Points vertices;
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0.5F, 1e-4F, 0),
        Eigen::Vector3f(0.5F, 1e-8F, 1)})
    vertices.push_back(p);
  Triangles sliver;
  sliver.push_back(0, 1, 2);
  EXPECT_EQ(find_used_vertices(vertices, sliver).num_unused, 1U) << "thin, but a surface";
  vertices.set(2, {0.5F, 1e-8F, 0});
  const UsedVertices none = find_used_vertices(vertices, sliver);
  EXPECT_EQ(none.num_unused, 4U);
  EXPECT_EQ(none.num_without_area, 1U);

  // The triangle that fills a T-junction has no area, but its vertices belong to faces with area.
  sliver.push_back(0, 1, 3);
  sliver.push_back(1, 2, 3);
  const UsedVertices joined = find_used_vertices(vertices, sliver);
  EXPECT_EQ(joined.num_unused, 0U);
  EXPECT_EQ(joined.num_without_area, 0U);
}

}  // namespace
}  // namespace trivet
