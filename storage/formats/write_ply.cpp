#include <fmt/format.h>

#include <string>

#include "storage/files/append.hpp"
#include "storage/files/file.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

using formats::append;

bool is_far(const Cloud& cloud) { return !cloud.offset.isZero(0); }

std::string header_of(const Cloud& cloud) {
  std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {1}\n"
      "property {0} x\nproperty {0} y\nproperty {0} z\n",
      is_far(cloud) ? "double" : "float", cloud.points.size());
  if (!cloud.normals.empty()) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!cloud.triangles.empty()) {
    header += fmt::format("element face {}\nproperty list uchar int vertex_indices\n",
                          cloud.triangles.size());
  }
  return header + "end_header\n";
}

}  // namespace

std::string encode_ply(const Cloud& cloud) {
  std::string out = header_of(cloud);
  out.reserve(out.size() + 24 * cloud.points.size() + 13 * cloud.triangles.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (is_far(cloud)) {
      append<double>(out, cloud.points[i].cast<double>() + cloud.offset);
    } else {
      append(out, cloud.points[i]);
    }
    if (!cloud.normals.empty()) append(out, cloud.normals[i]);
  }
  for (std::size_t t = 0; t < cloud.triangles.size(); ++t) {
    append(out, std::uint8_t{3});
    append(out, cloud.triangles.a[t]);
    append(out, cloud.triangles.b[t]);
    append(out, cloud.triangles.c[t]);
  }
  return out;
}

Result<void> write_ply(const std::filesystem::path& file, const Cloud& cloud) {
  const std::string bytes = encode_ply(cloud);
  return publish_file(file, std::as_bytes(std::span(bytes)));
}

}  // namespace trivet
