// glTF as JSON and binary: the transforms of its nodes, and references that must not be read.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>

#include "storage/formats/read_cloud.hpp"
#include "support/geometry_files.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using nlohmann::json;
using test::is_refused;
using test::kReadOptions;
using test::little;

/// Four corners of a square and the indices of its two triangles.
const std::string kCorners = little({0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.F});

json square() {
  return json::parse(R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48},
                    {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
    "buffers": [{"byteLength": 60}]})");
}
const std::string kBuffer = kCorners + little<std::uint16_t>({0, 1, 2, 0, 2, 3});

class ReadGltf : public testing::Test {
 protected:
  Result<Cloud> read(const json& document, const std::string& buffer = kBuffer,
                     const ReadOptions& options = kReadOptions) {
    return read_cloud(folder_.write("square.glb", test::glb_file(document.dump(), buffer)),
                      options);
  }
  void refused(const json& document, const std::string& text, const std::string& buffer = kBuffer) {
    EXPECT_TRUE(is_refused(read(document, buffer), text)) << document;
  }
  test::TempDir folder_;
};

Eigen::Vector3f normal_of(const Cloud& cloud, std::size_t t) {
  const Eigen::Vector3f a = cloud.points[cloud.triangles.a[t]];
  return (cloud.points[cloud.triangles.b[t]] - a).cross(cloud.points[cloud.triangles.c[t]] - a);
}

TEST_F(ReadGltf, ReadsTrianglesStripsAndFansWithIndicesOfEveryType) {
  struct Drawn {
    int mode;
    std::vector<int> indices;
  };
  for (const Drawn& drawn :
       {Drawn{4, {0, 1, 2, 0, 2, 3}}, Drawn{5, {0, 1, 3, 2}}, Drawn{6, {0, 1, 2, 3}}}) {
    for (const int type : {5121, 5123, 5125}) {
      std::string indices;
      for (const int index : drawn.indices) {
        indices += type == 5121   ? little(static_cast<std::uint8_t>(index))
                   : type == 5123 ? little(static_cast<std::uint16_t>(index))
                                  : little(static_cast<std::uint32_t>(index));
      }
      json document = square();
      document["meshes"][0]["primitives"][0]["mode"] = drawn.mode;
      document["accessors"][1]["componentType"] = type;
      document["accessors"][1]["count"] = drawn.indices.size();
      document["bufferViews"][1]["byteLength"] = indices.size();
      document["buffers"][0]["byteLength"] = 48 + indices.size();
      const auto cloud = read(document, kCorners + indices);
      ASSERT_TRUE(cloud) << cloud.error().message;
      EXPECT_EQ(cloud->points.size(), 4U);
      ASSERT_EQ(cloud->triangles.size(), 2U);
      for (std::size_t t = 0; t < 2; ++t)
        EXPECT_EQ(normal_of(*cloud, t), Eigen::Vector3f(0, 0, 1)) << drawn.mode << " " << type;
    }
  }
  json plain = square();
  plain["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", 0}}}, {"mode", 5}};
  ASSERT_TRUE(read(plain));
  EXPECT_EQ(read(plain)->triangles.size(), 2U);
  plain["meshes"][0]["primitives"][0]["mode"] = 4;
  refused(plain, "three corners");
}

TEST_F(ReadGltf, PutsMeshesWhereTheirNodesAre) {
  // A rotation about z by 90 degrees, a scale of 2 and a shift along x; then a shift of all along
  // y.
  const double half = std::sqrt(0.5);
  json document = square();
  document["nodes"] = {{{"children", {1, 2}}, {"translation", {0, 10, 0}}},
                       {{"mesh", 0}, {"matrix", {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 0, 0, 1}}},
                       {{"mesh", 0},
                        {"translation", {5, 0, 0}},
                        {"rotation", {0, 0, half, half}},
                        {"scale", {2, 2, 2}}}};
  const auto cloud = read(document);
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->points.size(), 8U);
  EXPECT_EQ(cloud->triangles.size(), 4U);
  const Eigen::Vector3f expected[] = {{5, 10, 0}, {5, 12, 0}, {3, 12, 0}, {3, 10, 0}};
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_LT((cloud->points[i] - expected[i % 4]).norm(), 1e-6F) << i;

  // A mirrored node: the outer side stays outside.
  document["nodes"] = {{{"mesh", 0}, {"scale", {1, 1, -1}}}};
  const auto mirrored = read(document);
  ASSERT_TRUE(mirrored) << mirrored.error().message;
  EXPECT_EQ(normal_of(*mirrored, 0), Eigen::Vector3f(0, 0, -1));
}

TEST_F(ReadGltf, IsInMetersUntilAnotherUnitIsAskedFor) {
  for (const auto& [unit, factor] : {std::pair(std::optional<LengthUnit>(), 1.F),
                                     std::pair(std::optional(LengthUnit::meter), 1.F),
                                     std::pair(std::optional(LengthUnit::millimeter), 1000.F)}) {
    const auto cloud = read(square(), kBuffer, {.unit = unit});
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_EQ(cloud->points[2], Eigen::Vector3f(factor, factor, 0));
  }
}

TEST_F(ReadGltf, TurnsNormalsAndKeepsThemWhereAllPartsHaveSome) {
  json document = square();
  document["accessors"][1] = document["accessors"][0];
  document["accessors"][1]["byteOffset"] = 0;
  document["bufferViews"] = {{{"buffer", 0}, {"byteLength", 96}, {"byteStride", 24}}};
  document["accessors"][1]["bufferView"] = 0;
  document["accessors"][1]["byteOffset"] = 12;
  document["buffers"][0]["byteLength"] = 96;
  document["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}},
                                            {"mode", 0}};
  document["nodes"][0]["scale"] = {1, 1, 2};
  std::string interleaved;
  for (std::size_t i = 0; i < 4; ++i)
    interleaved += kCorners.substr(12 * i, 12) + little({0.F, 0.6F, 0.8F});
  const auto cloud = read(document, interleaved);
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_TRUE(cloud->triangles.empty());
  ASSERT_EQ(cloud->points.size(), 4U);
  EXPECT_EQ(cloud->points[2], Eigen::Vector3f(1, 1, 0));
  ASSERT_EQ(cloud->normals.size(), 4U);
  EXPECT_LT((cloud->normals[3] - Eigen::Vector3f(0, 0.6F, 0.4F).normalized()).norm(), 1e-6F);
  json without = square();
  ASSERT_TRUE(read(without));
  EXPECT_TRUE(read(without)->normals.empty());
}

TEST_F(ReadGltf, ReadsBuffersInTheFileInBase64AndBesideIt) {
  const auto expected = read(square());
  ASSERT_TRUE(expected);
  folder_.write("the buffer.bin", kBuffer);
  std::filesystem::create_directory(folder_ / "inner");
  folder_.write("inner/b.bin", kBuffer);
  for (const std::string& uri :
       {"data:application/gltf-buffer;base64," + test::base64(kBuffer), std::string("inner/b.bin"),
        std::string("the%20buffer.bin"), std::string("./the buffer.bin")}) {
    json document = square();
    document["buffers"][0]["uri"] = uri;
    const auto cloud = read_cloud(folder_.write("square.gltf", document.dump(2)));
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_EQ(cloud->points.size(), 4U);
    EXPECT_EQ(cloud->triangles.c, expected->triangles.c);
  }
}

TEST_F(ReadGltf, ReadsNoFilesButThoseBelowItsFolder) {
  std::filesystem::create_directory(folder_ / "inner");
  const auto outside = folder_.write("outside.bin", kBuffer);
  std::filesystem::create_symlink(outside, folder_ / "inner" / "link.bin");
  json document = square();
  const auto read_inner = [&](const std::string& uri) {
    document["buffers"][0]["uri"] = uri;
    return read_cloud(folder_.write("inner/square.gltf", document.dump()));
  };
  for (const std::string& uri :
       {std::string("../outside.bin"), outside.string(), std::string("%2e%2e/outside.bin"),
        std::string("link.bin"), "file://" + outside.string(), std::string("a\0b", 3),
        std::string()})
    EXPECT_TRUE(is_refused(read_inner(uri), "uri")) << uri;
  EXPECT_TRUE(is_refused(read_inner("missing.bin"), "cannot be opened"));
  EXPECT_TRUE(is_refused(read_inner("data:text/plain,abc"), "base64"));
  EXPECT_TRUE(is_refused(read_inner("data:;base64,ab*d"), "base64"));
  EXPECT_TRUE(is_refused(read_inner("data:;base64,abcd"), "truncated"));
  // Bytes sent by a client have no folder to resolve paths in.
  document["buffers"][0]["uri"] = outside.string();
  const std::string text = document.dump();
  const auto sent = read_cloud(std::as_bytes(std::span(text)), "trivet_body.gltf");
  EXPECT_TRUE(is_refused(sent, ".glb"));
}

TEST_F(ReadGltf, ChecksEveryIndexAndRangeBeforeItReads) {
  const std::vector<std::pair<std::string, json>> lies{
      {"/scene", 1},
      {"/scenes/0/nodes/0", 1},
      {"/nodes/0/mesh", 7},
      {"/nodes/0/children", json{0}},
      {"/nodes/0/matrix", json{1, 2}},
      {"/nodes/0/rotation", json{0, 0, 0, 0}},
      {"/nodes/0/skin", 0},
      {"/nodes/0/weights", json{0.5}},
      {"/meshes/0/primitives/0/mode", 7},
      {"/meshes/0/primitives/0/indices", 2},
      {"/meshes/0/primitives/0/indices", 0},
      {"/meshes/0/primitives/0/indices", -1},
      {"/meshes/0/primitives/0/attributes/POSITION", 1},
      {"/meshes/0/primitives/0/attributes/POSITION", 1e30},
      {"/accessors/0/count", 5},
      {"/accessors/0/count", 0},
      {"/accessors/0/count", 2147483647},
      {"/accessors/0/byteOffset", 4},
      {"/accessors/0/componentType", 5125},
      {"/accessors/0/componentType", 5130},
      {"/accessors/0/bufferView", 9},
      {"/accessors/0/bufferView", nullptr},
      {"/accessors/0/sparse", json::object()},
      {"/accessors/1/componentType", 5125},
      {"/accessors/1/componentType", 5126},
      {"/accessors/1/count", 7},
      {"/bufferViews/0/byteStride", 4},
      {"/bufferViews/0/byteStride", 16},
      {"/bufferViews/0/buffer", 1},
      {"/bufferViews/0/byteOffset", 13},
      {"/bufferViews/0/byteOffset", 2147483647},
      {"/bufferViews/1/byteLength", 13},
      {"/buffers/0/byteLength", 61},
      {"/buffers", json::array()},
      {"/extensionsRequired", json{"KHR_draco_mesh_compression"}},
      {"/extensionsRequired", json{"EXT_mesh_gpu_instancing"}},
  };
  for (const auto& [path, value] : lies) {
    json document = square();
    document[json::json_pointer(path)] = value;
    const auto cloud = read(document);
    EXPECT_TRUE(is_refused(cloud, "")) << path << ": " << value;
    if (cloud) continue;
    EXPECT_EQ(cloud.error().message.find("more memory"), std::string::npos) << path;
  }
  refused(square(), "indices below 4, found 9",
          kCorners + little<std::uint16_t>({0, 1, 2, 0, 2, 9}));
  json compressed = square();
  compressed["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  refused(compressed, "without compression");
  json looks = square();
  looks["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_transform"};
  EXPECT_TRUE(read(looks));
  EXPECT_TRUE(is_refused(read(square(), kBuffer, {.max_points = 3}), "limit"));
}

TEST_F(ReadGltf, RefusesIncompleteContainers) {
  const std::string bytes = test::glb_file(square().dump(), kBuffer);
  const auto read_bytes = [&](const std::string& changed) {
    return read_cloud(folder_.write("a.glb", changed));
  };
  ASSERT_TRUE(read_bytes(bytes));
  for (std::size_t size = 4; size < bytes.size(); ++size)
    ASSERT_TRUE(is_refused(read_bytes(bytes.substr(0, size)), "truncated")) << size;
  EXPECT_TRUE(is_refused(read_bytes(bytes + "abcd"), "damaged"));
  std::string first = bytes, chunk = bytes;
  first[4] = 1;
  EXPECT_TRUE(is_refused(read_bytes(first), "version 2"));
  chunk[16] = 'B';
  EXPECT_TRUE(is_refused(read_bytes(chunk), "JSON"));
  chunk = bytes;
  chunk[15] = '\x7F';
  EXPECT_TRUE(is_refused(read_bytes(chunk), "byte 12"));
}

TEST_F(ReadGltf, StopsAtTheLimitHoweverOftenAMeshIsShown) {
  json document = square();
  document["nodes"].clear();
  document["scenes"][0]["nodes"].clear();
  for (int copy = 0; copy < 1000; ++copy) {
    document["nodes"].push_back({{"mesh", 0}});
    document["scenes"][0]["nodes"].push_back(copy);
  }
  EXPECT_TRUE(is_refused(read(document, kBuffer, {.max_points = 500}), "limit of 500"));
  const auto all = read(document);
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_EQ(all->points.size(), 4000U);
  // Nodes nested a thousand deep, and nodes in a cycle.
  document["scenes"][0]["nodes"] = {0};
  for (int node = 0; node < 999; ++node) document["nodes"][node]["children"] = {node + 1};
  ASSERT_TRUE(read(document));
  document["nodes"][999]["children"] = {500};
  refused(document, "twice");
}

}  // namespace
}  // namespace trivet
