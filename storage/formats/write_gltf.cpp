#include <fmt/format.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "storage/files/append.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_text.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

using formats::append;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxBytes =
    0x7FFF'0000;  // limit for the parts; many readers are limited to 2 GiB

enum ComponentType { kUnsignedInt = 5125, kFloat = 5126 };
enum Target { kVertices = 34962, kIndices = 34963 };
enum Mode { kPoints = 0, kTriangles = 4 };

/// The binary chunk, and its description in the document.
class Buffer {
 public:
  void add(PointsView vectors, bool bounded) {
    describe(vectors.size() * 12, vectors.size(), kFloat, "VEC3", kVertices);
    Eigen::AlignedBox3f box;
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      append(bytes_, vectors[i]);
      box.extend(vectors[i]);
    }
    if (!bounded) return;
    for (const auto& [name, corner] : {std::pair{"min", box.min()}, std::pair{"max", box.max()}})
      accessors_.back()[name] = {corner.x(), corner.y(), corner.z()};
  }
  void add(TrianglesView triangles) {
    describe(triangles.size() * 12, triangles.size() * 3, kUnsignedInt, "SCALAR", kIndices);
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (const std::uint32_t corner : {triangles.a[t], triangles.b[t], triangles.c[t]})
        append(bytes_, corner);
  }

  const std::string& bytes() const noexcept { return bytes_; }
  const Json& views() const noexcept { return views_; }
  const Json& accessors() const noexcept { return accessors_; }

 private:
  void describe(std::size_t num_bytes, std::size_t count, ComponentType component, const char* type,
                Target target) {
    accessors_.push_back({{"bufferView", views_.size()},
                          {"componentType", component},
                          {"count", count},
                          {"type", type}});
    views_.push_back({{"buffer", 0},
                      {"byteOffset", bytes_.size()},
                      {"byteLength", num_bytes},
                      {"target", target}});
  }

  std::string bytes_;
  Json views_ = Json::array(), accessors_ = Json::array();
};

void append_chunk(std::string& out, std::string_view type, std::string bytes, char padding) {
  bytes.resize((bytes.size() + 3) / 4 * 4, padding);
  append(out, static_cast<std::uint32_t>(bytes.size()));
  out += type;
  out += bytes;
}

std::string encode_glb(const Cloud& cloud, LengthUnit unit) {
  Buffer buffer;
  Json attributes, primitive;
  const auto last = [&] { return buffer.accessors().size() - 1; };
  buffer.add(cloud.points, true);
  attributes["POSITION"] = last();
  if (!cloud.normals.empty()) {
    buffer.add(cloud.normals, false);
    attributes["NORMAL"] = last();
  }
  primitive["attributes"] = std::move(attributes);
  if (!cloud.triangles.empty()) {
    buffer.add(cloud.triangles);
    primitive["indices"] = last();
  }
  primitive["mode"] = cloud.triangles.empty() ? kPoints : kTriangles;

  Json node{{"mesh", 0}};
  const double meters = unit_scale(unit, LengthUnit::meter);
  if (meters != 1) node["scale"] = {meters, meters, meters};
  if (!cloud.offset.isZero(0)) {
    const Eigen::Vector3d offset = meters * cloud.offset;
    node["translation"] = {offset.x(), offset.y(), offset.z()};
  }
  const Json document{{"asset", {{"version", "2.0"}, {"generator", "trivet"}}},
                      {"scene", 0},
                      {"scenes", {{{"nodes", {0}}}}},
                      {"nodes", {node}},
                      {"meshes", {{{"primitives", {primitive}}}}},
                      {"buffers", {{{"byteLength", buffer.bytes().size()}}}},
                      {"bufferViews", buffer.views()},
                      {"accessors", buffer.accessors()}};
  std::string chunks;
  append_chunk(chunks, "JSON", json_text(document), ' ');
  append_chunk(chunks, {"BIN\0", 4}, buffer.bytes(), '\0');
  std::string out = "glTF";
  append(out, std::uint32_t{2});
  append(out, static_cast<std::uint32_t>(12 + chunks.size()));
  return out + chunks;
}

}  // namespace

Result<void> write_glb(const std::filesystem::path& file, const Cloud& cloud, LengthUnit unit) {
  if (12 * (cloud.points.size() + cloud.normals.size() + cloud.triangles.size()) > kMaxBytes) {
    return Error{ErrorCode::usage,
                 fmt::format("{}: {} points and {} triangles are more than a file of glTF can be "
                             "relied on to hold; write them as PLY",
                             file.string(), cloud.points.size(), cloud.triangles.size())};
  }
  const std::string bytes = encode_glb(cloud, unit);
  return publish_file(file, std::as_bytes(std::span(bytes)));
}

}  // namespace trivet
