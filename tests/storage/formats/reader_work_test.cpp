// The memory and time of reading grow with the file in every format; a few bytes cannot demand
// much.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "storage/formats/read_cloud.hpp"
#include "support/allocations.hpp"
#include "support/degenerate_geometry.hpp"
#include "support/geometry_files.hpp"

namespace trivet {
namespace {

/// A strip of triangles between n points on a curve.
Cloud twisted_strip(std::size_t n) {
  Cloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const auto t = static_cast<float>(i) / static_cast<float>(n);
    cloud.points.push_back({std::cos(20 * t), std::sin(20 * t), 2 + 5 * t});
  }
  for (std::uint32_t i = 0; i + 2 < n; ++i) cloud.triangles.push_back(i, i + 1, i + 2);
  return cloud;
}

std::string packed_points(const Cloud& cloud) {
  std::string bytes;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f p = cloud.points[i];
    bytes += test::little({p.x(), p.y(), p.z()});
  }
  return bytes;
}

std::string text_points(const Cloud& cloud) {
  std::string text;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f p = cloud.points[i];
    text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  }
  return text;
}

std::string text_faces(const Cloud& cloud) {
  std::string text;
  const Triangles& t = cloud.triangles;
  for (std::size_t k = 0; k < t.size(); ++k)
    text += fmt::format("3 {} {} {}\n", t.a[k], t.b[k], t.c[k]);
  return text;
}

std::string packed_faces(const Cloud& cloud, bool with_counts) {
  std::string bytes;
  const Triangles& t = cloud.triangles;
  for (std::size_t k = 0; k < t.size(); ++k) {
    if (with_counts) bytes += test::little(std::uint8_t{3});
    bytes += test::little({t.a[k], t.b[k], t.c[k]});
  }
  return bytes;
}

std::string ply_of(const std::string& format, const Cloud& cloud, const std::string& body) {
  return fmt::format(
             "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
             "property float z\nelement face {}\nproperty list uchar int "
             "vertex_indices\nend_header\n",
             format, cloud.points.size(), cloud.triangles.size()) +
         body;
}

std::string stl_of(const Cloud& cloud) {
  std::string bytes(80, ' ');
  bytes += test::little(static_cast<std::uint32_t>(cloud.triangles.size()));
  const Triangles& t = cloud.triangles;
  for (std::size_t k = 0; k < t.size(); ++k) {
    bytes += std::string(12, '\0');
    for (const std::uint32_t v : {t.a[k], t.b[k], t.c[k]}) {
      const Eigen::Vector3f p = cloud.points[v];
      bytes += test::little({p.x(), p.y(), p.z()});
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

std::string glb_of(const Cloud& cloud) {
  const std::string points = packed_points(cloud), faces = packed_faces(cloud, false);
  const std::string document = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"accessors":[)"
      R"({{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}},)"
      R"({{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}],"bufferViews":[)"
      R"({{"buffer":0,"byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":{}}}],)"
      R"("buffers":[{{"byteLength":{}}}]}})",
      cloud.points.size(), 3 * cloud.triangles.size(), points.size(), points.size(), faces.size(),
      points.size() + faces.size());
  return test::glb_file(document, points + faces);
}

std::vector<std::uint16_t> some_depths(std::size_t n) {
  std::vector<std::uint16_t> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = static_cast<std::uint16_t>(1000 + i % 100);
  return values;
}

struct FileFormat {
  std::string name;
  std::function<std::string(std::size_t n)> file;
};

const std::vector<FileFormat>& file_formats() {
  static const std::vector<FileFormat> all{
      {"a.ply",
       [](std::size_t n) {
         const Cloud cloud = twisted_strip(n);
         return ply_of("ascii", cloud, text_points(cloud) + text_faces(cloud));
       }},
      {"b.ply",
       [](std::size_t n) {
         const Cloud cloud = twisted_strip(n);
         return ply_of("binary_little_endian", cloud,
                       packed_points(cloud) + packed_faces(cloud, true));
       }},
      {"a.obj", [](std::size_t n) { return test::obj_file(twisted_strip(n)); }},
      {"a.stl", [](std::size_t n) { return stl_of(twisted_strip(n)); }},
      {"a.off",
       [](std::size_t n) {
         const Cloud cloud = twisted_strip(n);
         return fmt::format("OFF\n{} {} 0\n", n, cloud.triangles.size()) + text_points(cloud) +
                text_faces(cloud);
       }},
      {"a.xyz", [](std::size_t n) { return text_points(twisted_strip(n)); }},
      {"a.xyz.gz", [](std::size_t n) { return test::gzip_file(text_points(twisted_strip(n))); }},
      {"a.pcd",
       [](std::size_t n) {
         return fmt::format(
                    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
                    "WIDTH {}\nHEIGHT 1\nPOINTS {}\nDATA binary\n",
                    n, n) +
                packed_points(twisted_strip(n));
       }},
      {"a.npy",
       [](std::size_t n) {
         return test::npy_file("<f4", fmt::format("({}, 3)", n), packed_points(twisted_strip(n)));
       }},
      {"a.glb", [](std::size_t n) { return glb_of(twisted_strip(n)); }},
      {"a.png",
       [](std::size_t n) {
         return test::depth_png(64, static_cast<std::uint32_t>(n / 64), some_depths(n / 64 * 64));
       }},
      {"a.tif",
       [](std::size_t n) {
         std::string pixels;
         for (const std::uint16_t d : some_depths(n / 64 * 64)) pixels += test::little(d);
         return test::tiff_file(64, static_cast<std::uint32_t>(n / 64), 16, 1, pixels);
       }},
  };
  return all;
}

std::size_t work_of(const std::string& file, const std::string& name, std::size_t least_points) {
  const std::span bytes(reinterpret_cast<const std::byte*>(file.data()), file.size());
  std::size_t num_points = 0;
  const std::size_t work = test::bytes_in([&] {
    const Result<Cloud> cloud = read_cloud(bytes, name, test::kReadOptions);
    ASSERT_TRUE(cloud) << cloud.error().message;
    num_points = cloud->points.size();
  });
  EXPECT_GE(num_points, least_points) << name;
  return work;
}

TEST(ReaderWork, GrowsAsTheFileOfEveryFormat) {
  for (const FileFormat& format : file_formats()) {
    constexpr std::size_t n = 4096;
    std::size_t before = work_of(format.file(n), format.name, n);
    for (const std::size_t times : {2, 4}) {
      const std::size_t work = work_of(format.file(times * n), format.name, times * n);
      EXPECT_LE(work, before * 5 / 2) << format.name << " at " << times << " n";
      before = work;
    }
    EXPECT_LE(before, 800 * 4 * n) << format.name;
  }
}

// Coincident triangles and triangles without area cost no more work than others.
TEST(ReaderWork, GrowsAsTheFileOfDegenerateMeshes) {
  for (const auto& make : {test::layered_tetrahedron, test::shifted_tetrahedra}) {
    std::size_t before = work_of(test::obj_file(make(1024)), "a.obj", 4);
    for (const std::size_t times : {2, 4}) {
      const std::size_t work = work_of(test::obj_file(make(times * 1024)), "a.obj", 4);
      EXPECT_LE(work, before * 5 / 2) << times << " n";
      before = work;
    }
  }
}

TEST(ReaderWork, OfDegenerateMeshesIsARefusalOrACloud) {
  for (const test::DegenerateMesh& mesh : test::degenerate_meshes()) {
    for (const bool keep_origin : {false, true}) {
      const std::string file = test::obj_file(mesh.cloud);
      const ReadOptions options{.keep_origin = keep_origin};
      const Result<Cloud> cloud = read_cloud(
          {reinterpret_cast<const std::byte*>(file.data()), file.size()}, "a.obj", options);
      if (cloud) {
        EXPECT_TRUE(test::is_valid(*cloud)) << mesh.name;
      } else {
        EXPECT_EQ(cloud.error().code, ErrorCode::bad_data) << mesh.name;
      }
    }
  }
}

}  // namespace
}  // namespace trivet
