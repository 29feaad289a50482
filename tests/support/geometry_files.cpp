#include "support/geometry_files.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>

namespace trivet::test {
namespace {

std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0xEDB88320 : 0);
  }
  return ~crc;
}

std::uint32_t adler32(std::string_view bytes) {
  std::uint32_t a = 1, b = 0;
  for (const char c : bytes) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  return b << 16 | a;
}

std::string chunk(const std::string& type, std::string_view data) {
  const std::string body = type + std::string(data);
  return big(static_cast<std::uint32_t>(data.size())) + body + big(crc32(body));
}

const std::string kPcdFields =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\n"
    "TYPE F F F F F F\nCOUNT 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 2\nVIEWPOINT 0 0 1 1 0 0 0\nPOINTS 4\n";

std::string stl_facet(std::initializer_list<float> corners) {
  return little({0.0F, 0.0F, 1.0F}) + little(corners) + little(std::uint16_t{0});
}

}  // namespace

std::string lzf_literals(std::string_view bytes) {
  std::string out;
  for (; !bytes.empty(); bytes.remove_prefix(std::min<std::size_t>(32, bytes.size()))) {
    const auto run = bytes.substr(0, 32);
    out += static_cast<char>(run.size() - 1);
    out += run;
  }
  return out;
}

std::string png_file(std::uint32_t width, std::uint32_t height, int bits, int color_type,
                     std::string_view rows) {
  const std::string header = big(width) + big(height) + static_cast<char>(bits) +
                             static_cast<char>(color_type) + std::string(3, '\0');
  const auto length = static_cast<std::uint16_t>(rows.size());
  const std::string stream = "\x78\x01" + std::string("\x01") + little(length) +
                             little(static_cast<std::uint16_t>(~length)) + std::string(rows) +
                             big(adler32(rows));
  return "\x89PNG\r\n\x1A\n" + chunk("IHDR", header) + chunk("IDAT", stream) + chunk("IEND", "");
}

std::string depth_png(std::uint32_t width, std::uint32_t height,
                      const std::vector<std::uint16_t>& depths) {
  std::string rows;
  for (std::size_t pixel = 0; pixel < depths.size(); ++pixel) {
    if (pixel % width == 0) rows += '\0';
    rows += big(depths[pixel]);
  }
  return png_file(width, height, 16, 0, rows);
}

std::string tiff_file(std::uint32_t width, std::uint32_t height, int bits, int format,
                      std::string_view pixels, int samples) {
  struct Entry {
    int tag, type;  // types: 3 of 16 bits, 4 of 32
    std::uint32_t value;
  };
  constexpr std::uint32_t kPixelsBegin = 8 + 2 + 10 * 12 + 4;
  const auto size = static_cast<std::uint32_t>(pixels.size());
  const std::vector<Entry> entries{{256, 4, width},
                                   {257, 4, height},
                                   {258, 3, static_cast<std::uint32_t>(bits)},
                                   {259, 3, 1},
                                   {262, 3, 1},
                                   {273, 4, kPixelsBegin},
                                   {277, 3, static_cast<std::uint32_t>(samples)},
                                   {278, 4, height},
                                   {279, 4, size},
                                   {339, 3, static_cast<std::uint32_t>(format)}};
  std::string out = "II*" + std::string(1, '\0') + little(std::uint32_t{8}) +
                    little(static_cast<std::uint16_t>(entries.size()));
  for (const Entry& entry : entries) {
    out += little(static_cast<std::uint16_t>(entry.tag)) +
           little(static_cast<std::uint16_t>(entry.type)) + little(std::uint32_t{1}) +
           little(entry.value);
  }
  return out + little(std::uint32_t{0}) + std::string(pixels);
}

std::string glb_file(std::string json, std::string buffer) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  const auto length = [](std::size_t size) { return little(static_cast<std::uint32_t>(size)); };
  const std::string version = little(std::uint32_t{2});
  return "glTF" + version + length(12 + 8 + json.size() + 8 + buffer.size()) + length(json.size()) +
         "JSON" + json + length(buffer.size()) + std::string("BIN\0", 4) + buffer;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k > bytes.size() ? '=' : kAlphabet[bits >> (18 - 6 * k) & 63];
  }
  return out;
}

std::string npy_file(const std::string& type, const std::string& shape, const std::string& body,
                     bool fortran_order, int version) {
  const std::string header = "{'descr': '" + type +
                             "', 'fortran_order': " + (fortran_order ? "True" : "False") +
                             ", 'shape': " + shape + ", }\n";
  const auto length = static_cast<std::uint32_t>(header.size());
  return std::string("\x93NUMPY") + static_cast<char>(version) + '\0' +
         (version == 1 ? little(static_cast<std::uint16_t>(length)) : little(length)) + header +
         body;
}

std::string gzip_file(std::string_view bytes, int level) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, level, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::vector<SampleFile> sample_files() {
  const std::string vertices =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 2\nproperty list uchar int vertex_indices\n";
  const auto triangle = [](std::int32_t a, std::int32_t b, std::int32_t c) {
    return little(std::uint8_t{3}) + little({a, b, c});
  };
  const auto triangle_big = [](std::int32_t a, std::int32_t b, std::int32_t c) {
    return big(std::uint8_t{3}) + big(a) + big(b) + big(c);
  };
  const auto face_big = [](std::int32_t a, std::int32_t b, std::int32_t c) {
    return big(std::int32_t{3}) + big(a) + big(b) + big(c) + big(std::int32_t{0});
  };
  const std::string corners = little({0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.5F});
  std::string corners_big;
  for (const float v : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.5F})
    corners_big += big(v);

  const std::string quad =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)"
      R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
      R"({"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}],"bufferViews":[)"
      R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":6}],)"
      R"("buffers":[{"byteLength":54)";
  const std::string quad_bytes = corners + std::string("\0\1\2\0\2\3", 6);
  std::string corners_big_with_normals;
  for (const float v : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 0.6F, -0.8F})
    corners_big_with_normals += big(v);
  std::string depths;
  for (std::uint16_t pixel = 0; pixel < 256; ++pixel)
    depths += little(static_cast<std::uint16_t>(pixel % 7 * 1000));

  const float nan = std::nanf("");
  const std::string row_major =
      little({0.F, 0.F, 2.F, 0.F, 0.F, -1.F, 1.F, 0.F, 2.F, 0.F, 0.F, -1.F}) +
      little({nan, nan, nan, nan, nan, nan, 1.F, 1.F, 2.F, 0.F, 0.F, -1.F});
  const std::string field_major =
      little({0.F, 1.F, nan, 1.F, 0.F, 0.F, nan, 1.F, 2.F, 2.F, nan, 2.F}) +
      little({0.F, 0.F, nan, 0.F, 0.F, 0.F, nan, 0.F, -1.F, -1.F, nan, -1.F});
  const std::string packed = lzf_literals(field_major);

  return {
      {"ascii.ply", "ply\nformat ascii 1.0\ncomment made by hand\n" + vertices + faces +
                        "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n3 0 1 2\n3 0 2 3\n"},
      {"little.ply", "ply\nformat binary_little_endian 1.0\n" + vertices + faces + "end_header\n" +
                         corners + triangle(0, 1, 2) + triangle(0, 2, 3)},
      {"big.ply", "ply\nformat binary_big_endian 1.0\n" + vertices + faces + "end_header\n" +
                      corners_big + triangle_big(0, 1, 2) + triangle_big(0, 2, 3)},
      {"strips.ply", "ply\nformat ascii 1.0\n" + vertices +
                         "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                         "0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n8 0 1 2 3 -1 3 2 1\n"},
      {"grid.ply", "ply\nformat ascii 1.0\nobj_info num_cols 3\nobj_info num_rows 2\n" + vertices +
                       "element range_grid 6\nproperty list uchar int vertex_indices\nend_header\n"
                       "0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n1 0\n0\n1 1\n1 2\n0\n1 3\n"},
      {"ascii.pcd",
       kPcdFields +
           "DATA ascii\n0 0 2 0 0 -1\n1 0 2 0 0 -1\nnan nan nan nan nan nan\n1 1 2 0 0 -1\n"},
      {"binary.pcd", kPcdFields + "DATA binary\n" + row_major},
      {"compressed.pcd", kPcdFields + "DATA binary_compressed\n" +
                             little(static_cast<std::uint32_t>(packed.size())) +
                             little(static_cast<std::uint32_t>(field_major.size())) + packed},
      {"quad.obj",
       "# a square\nmtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvn 0 0 1\nvn 0 0 1\n"
       "vn 0 0 1\nvn 0 0 1\nf 1//1 2//2 3//3 4//4\nf -4 -3 -2\n"},
      {"text.stl",
       "solid vertex\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 "
       "0\nendloop\n"
       "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 "
       "0.5\nendloop\n"
       "endfacet\nendsolid vertex\n"},
      {"binary.stl", "solid, and yet binary" + std::string(59, ' ') + little(std::uint32_t{2}) +
                         stl_facet({0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F}) +
                         stl_facet({0.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.5F})},
      {"normals.off",
       "NOFF # with normals\n4 2 0\n\n0 0 0 0 0 1\n1 0 0 0 0 1\n# half way\n1 1 0 0 0 1\n"
       "0 1 0.5 0 0 1\n3 0 1 2\n3 0 2 3 255 0 0\n"},
      {"binary.off", "OFF BINARY\n" + big(std::int32_t{4}) + big(std::int32_t{2}) +
                         big(std::int32_t{0}) + corners_big + face_big(0, 1, 2) +
                         face_big(0, 2, 3)},
      {"concave.obj", "v 0 0 0\nv 2 0 0\nv 0.5 0.5 0\nv 0 2 0\nv 0 0 1\nf 2 3 4 1\nf 1 2 5\n"},
      {"points.xyz", "# x y z\n0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n"},
      {"named.csv", "id;\"Z [m]\";y;x\na;0;0;0\nb;0;0;1\nc;0;1;1\nd;0,5;1;0\n"},
      {"counted.pts", "4\n0 0 0 -9 1 2 3\n1 0 0 -9 1 2 3\n1 1 0 -9 1 2 3\n0 1 0.5 -9 1 2 3\n"},
      {"quad.glb", glb_file(quad + "}]}", quad_bytes)},
      {"quad.gltf",
       quad + R"(,"uri":"data:application/octet-stream;base64,)" + base64(quad_bytes) + "\"}]}"},
      {"points.npy", npy_file("<f4", "(4, 3)", corners)},
      {"normals.npy", npy_file(">f4", "(2, 6)", corners_big_with_normals, false, 2)},
      {"organized.npy",
       npy_file("<f8", "(2, 2, 3)", little({0., 1., 0., 1., 0., 0., 1., 1., 2., 2., 2., 0. / 0.}),
                true)},
      {"depth.npy", npy_file("<u2", "(16, 16)", depths, false, 3)},
      {"depth.tif", tiff_file(3, 2, 32, 3, little({1000.F, 0.F, nan, 3000.F, 0.F, 65535.F}))},
      {"points.xyz.gz", gzip_file("0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n")},
      {"depth.png", depth_png(3, 2, {1000, 0, 2000, 3000, 0, 65535})},
  };
}

testing::AssertionResult is_valid(const Cloud& cloud) {
  const std::size_t n = cloud.points.size();
  if (n == 0 && !cloud.grid) return testing::AssertionFailure() << "no points";
  if (!(cloud.offset.cwiseAbs().maxCoeff() <= kMaxCoordinate))
    return testing::AssertionFailure() << "offset";
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3f p = cloud.points[i];
    if (!(p.allFinite() && p.cwiseAbs().maxCoeff() <= 1e7F))
      return testing::AssertionFailure() << "point " << i;
  }
  if (!cloud.normals.empty() && cloud.normals.size() != n)
    return testing::AssertionFailure() << "normals";
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    if (!cloud.normals[i].allFinite()) return testing::AssertionFailure() << "normal " << i;
  }
  const Triangles& triangles = cloud.triangles;
  if (triangles.b.size() != triangles.size() || triangles.c.size() != triangles.size()) {
    return testing::AssertionFailure() << "triangle columns";
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (std::max({triangles.a[t], triangles.b[t], triangles.c[t]}) >= n) {
      return testing::AssertionFailure() << "triangle " << t;
    }
  }
  if (!cloud.grid) return testing::AssertionSuccess();
  if (cloud.grid->point_index.size() != std::size_t{cloud.grid->width} * cloud.grid->height) {
    return testing::AssertionFailure() << "size of the grid";
  }
  for (const std::int32_t point : cloud.grid->point_index) {
    if (point < PixelGrid::kNone || (point >= 0 && static_cast<std::size_t>(point) >= n)) {
      return testing::AssertionFailure() << "pixel with point " << point;
    }
  }
  return testing::AssertionSuccess();
}

testing::AssertionResult is_refused(const Result<Cloud>& result, std::string_view text) {
  if (result) return testing::AssertionFailure() << "read " << result->points.size() << " points";
  const Error& error = result.error();
  if (error.code != ErrorCode::bad_data)
    return testing::AssertionFailure() << "other code: " << error.message;
  const bool named = error.message.find("trivet_") != std::string::npos;
  const bool said = error.message.find(text) != std::string::npos;
  return (named && said ? testing::AssertionSuccess() : testing::AssertionFailure())
         << error.message;
}

}  // namespace trivet::test
