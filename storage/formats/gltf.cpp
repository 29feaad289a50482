#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <vector>

#include "storage/files/text.hpp"
#include "storage/formats/gltf_file.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

using Transform = Eigen::Affine3d;

/// Required extensions may change the shapes, or only the appearance.
void check_extensions(const JsonNode& root) {
  if (!root.has("extensionsRequired")) return;
  for (const JsonNode& extension : root.at("extensionsRequired").elements()) {
    const std::string name = extension.string();
    const bool only_appearance = name.starts_with("KHR_materials_") ||
                                 name.starts_with("KHR_texture_") ||
                                 name.starts_with("EXT_texture_") || name == "KHR_lights_punctual";
    if (only_appearance || name == "KHR_mesh_quantization") continue;
    const bool packed = name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression";
    extension.refuse(
        fmt::format("the file needs the extension {}, which is not read; export it "
                    "without {}",
                    quote(name), packed ? "compression" : "it"));
  }
}

std::vector<double> numbers_of(const JsonNode& node, std::size_t count) {
  auto numbers = node.flat_numbers();
  if (numbers.size() != count) node.refuse(fmt::format("expected {} numbers", count));
  return numbers;
}

/// Source: glTF 2.0, 3.5.3.
Transform transform_of(const JsonNode& node) {
  Transform out = Transform::Identity();
  if (node.has("matrix")) {
    const auto m = numbers_of(node.at("matrix"), 16);
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      node.at("matrix").refuse("expected an affine matrix: 0, 0, 0, 1 in its last row");
    out.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
    return out;
  }
  if (node.has("translation")) {
    const auto t = numbers_of(node.at("translation"), 3);
    out.translate(Eigen::Vector3d(t[0], t[1], t[2]));
  }
  if (node.has("rotation")) {
    const auto q = numbers_of(node.at("rotation"), 4);
    const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
    if (!(rotation.norm() > 0.5 && rotation.norm() < 2))
      node.at("rotation").refuse("expected a unit quaternion");
    out.rotate(rotation.normalized());
  }
  if (node.has("scale")) {
    const auto s = numbers_of(node.at("scale"), 3);
    out.scale(Eigen::Vector3d(s[0], s[1], s[2]));
  }
  return out;
}

/// Traverses the scene and joins the meshes of its nodes.
class GltfReader {
 public:
  GltfReader(const Input& input, const JsonNode& root, std::span<const std::byte> binary)
      : input_(input),
        root_(root),
        buffers_(input, root, binary),
        nodes_(elements_of(root, "nodes")),
        meshes_(elements_of(root, "meshes")) {}

  Cloud read() {
    check_extensions(root_);
    walk();
    if (triangles_.points.empty() && loose_.points.empty())
      root_.refuse("expected triangles or points in the scene, found none");
    Cloud& cloud = triangles_.points.empty() ? loose_ : triangles_;
    const bool with_normals = triangles_.points.empty() ? loose_normals_ : triangle_normals_;
    if (!with_normals) cloud.normals = {};
    return std::move(cloud);
  }

 private:
  /// The root nodes: those of the scene, or if there is none, of the file.
  std::vector<std::size_t> roots() const {
    std::vector<std::size_t> roots;
    const auto scenes = elements_of(root_, "scenes");
    if (!scenes.empty()) {
      const JsonNode& scene =
          root_.has("scene") ? element_at(root_.at("scene"), scenes) : scenes[0];
      return scene.has("nodes") ? node_list(scene.at("nodes")) : roots;
    }
    std::vector<bool> is_child(nodes_.size(), false);
    for (const JsonNode& node : nodes_) {
      if (!node.has("children")) continue;
      for (const std::size_t child : node_list(node.at("children"))) is_child[child] = true;
    }
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      if (!is_child[n]) roots.push_back(n);
    return roots;
  }

  std::vector<std::size_t> node_list(const JsonNode& list) const {
    std::vector<std::size_t> indices;
    for (const JsonNode& index : list.elements()) {
      indices.push_back(static_cast<std::size_t>(&element_at(index, nodes_) - nodes_.data()));
    }
    return indices;
  }

  /// Depth first with an explicit stack: files may nest to any depth.
  void walk() {
    struct Visit {
      std::size_t node;
      Transform above;
    };
    const auto unit = input_.options.unit.value_or(LengthUnit::meter);
    const Transform scene(Eigen::Scaling(unit_scale(LengthUnit::meter, unit)));
    std::vector<Visit> open;
    for (const std::size_t node : roots()) open.push_back({node, scene});
    std::reverse(open.begin(), open.end());
    std::vector<bool> visited(nodes_.size(), false);
    while (!open.empty()) {
      const Visit visit = open.back();
      open.pop_back();
      const JsonNode& node = nodes_[visit.node];
      if (visited[visit.node])
        node.refuse("expected one parent a node, found it twice in the scene");
      visited[visit.node] = true;
      const Transform transform = visit.above * transform_of(node);
      if (node.has("mesh")) add_mesh(node, transform);
      if (!node.has("children")) continue;
      const auto children = node_list(node.at("children"));
      for (auto child = children.rbegin(); child != children.rend(); ++child)
        open.push_back({*child, transform});
    }
  }

  void add_mesh(const JsonNode& node, const Transform& transform) {
    if (node.has("skin")) node.refuse("has a skin, which bends; export a rigid mesh");
    const JsonNode& mesh = element_at(node.at("mesh"), meshes_);
    for (const JsonNode& morphed : {node, mesh}) {
      if (!morphed.has("weights")) continue;
      for (const double weight : morphed.at("weights").flat_numbers())
        if (weight != 0) morphed.refuse("is morphed by weights; export a rigid mesh");
    }
    for (const JsonNode& primitive : mesh.at("primitives").elements())
      add_primitive(primitive, transform);
  }

  void add_primitive(const JsonNode& primitive, const Transform& transform) {
    enum Mode { kPoints = 0, kTriangles = 4, kStrip = 5, kFan = 6 };
    const int mode = primitive.has("mode") ? primitive.at("mode").integer(0, 6) : kTriangles;
    if (mode != kPoints && mode < kTriangles) return;  // lines
    const JsonNode attributes = primitive.at("attributes").object();
    if (!attributes.has("POSITION")) return;  // glTF 2.0, 3.7.2.1: skip it
    const GltfAccessor positions = buffers_.accessor(attributes.at("POSITION"), "VEC3");
    std::optional<GltfAccessor> normals, indices;
    if (attributes.has("NORMAL")) {
      normals = buffers_.accessor(attributes.at("NORMAL"), "VEC3");
      if (normals->size() != positions.size())
        attributes.refuse("expected as many normals as positions");
    }
    if (primitive.has("indices")) indices = buffers_.accessor(primitive.at("indices"), "SCALAR");

    const std::size_t count = indices ? indices->size() : positions.size();
    num_corners_ += count;
    if (num_corners_ / 3 > input_.max_points()) {
      primitive.refuse(fmt::format("the scene has more triangles or points than the limit of {}",
                                   input_.max_points()));
    }
    // A mirrored mesh keeps its outer side.
    const bool mirrored = transform.linear().determinant() < 0;
    const Part part{primitive,
                    transform,
                    transform.matrix().isIdentity(0),
                    normal_matrix(transform.linear(), mirrored),
                    positions,
                    normals,
                    indices,
                    mode == kPoints ? loose_ : triangles_};
    (mode == kPoints ? loose_normals_ : triangle_normals_) &= normals.has_value();
    if (mode == kTriangles && count % 3 != 0)
      primitive.refuse(fmt::format("expected three corners a triangle, found {}", count));
    place_vertices(part, count);
    if (mode == kPoints) return;
    const auto vertex = [&](std::size_t corner) {
      return places_[corner_vertex(part, corner)].point;
    };
    for (std::size_t i = 0; i + 2 < count; i += mode == kTriangles ? 3 : 1) {
      const std::size_t first = mode == kFan ? 0 : i;
      const bool turned = mirrored != (mode == kStrip && i % 2 == 1);
      const std::uint32_t a = vertex(first), b = vertex(i + 1), c = vertex(i + 2);
      part.cloud.triangles.push_back(a, turned ? c : b, turned ? b : c);
    }
  }

  /// Output index of a vertex, valid if `part` is the current part: nothing has to be cleared in
  /// between.
  struct Place {
    std::uint64_t part = 0;
    std::uint32_t point = 0;
  };

  /// A primitive to be added to the cloud.
  struct Part {
    const JsonNode& node;
    const Transform& transform;
    bool as_is;  ///< the transform is the identity
    Eigen::Matrix3d normal_matrix;
    const GltfAccessor& positions;
    const std::optional<GltfAccessor>&normals, &indices;
    Cloud& cloud;
  };

  static std::size_t corner_vertex(const Part& part, std::size_t corner) {
    return part.indices ? part.indices->index(corner) : corner;
  }

  /// Add the vertices of `count` corners to the cloud, each once and in their order. Vertices
  /// shared by many primitives are not traversed for each.
  void place_vertices(const Part& part, std::size_t count) {
    const std::size_t num_vertices = part.positions.size();
    places_.resize(std::max(places_.size(), num_vertices));
    used_.clear();
    ++num_parts_;
    for (std::size_t corner = 0; corner < count; ++corner) {
      const std::size_t v = corner_vertex(part, corner);
      if (v >= num_vertices)
        part.node.refuse(fmt::format("expected indices below {}, found {}", num_vertices, v));
      if (places_[v].part == num_parts_) continue;
      places_[v].part = num_parts_;
      used_.push_back(v);
    }
    if (part.cloud.points.size() + used_.size() > input_.max_points()) {
      part.node.refuse(
          fmt::format("the scene has more points than the limit of {}", input_.max_points()));
    }
    std::ranges::sort(used_);
    for (const std::size_t v : used_) {
      places_[v].point = static_cast<std::uint32_t>(part.cloud.points.size());
      add_vertex(part, v);
    }
  }

  static void add_vertex(const Part& part, std::size_t v) {
    const auto vector = [&](const GltfAccessor& from) {
      return Eigen::Vector3d(from.value(v, 0), from.value(v, 1), from.value(v, 2));
    };
    const auto add = [](const Eigen::Vector3d& value, Points& points) {
      points.push_back({to_float(value.x()), to_float(value.y()), to_float(value.z())});
    };
    const Eigen::Vector3d position = vector(part.positions);
    add(part.as_is ? position : part.transform * position, part.cloud.points);
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    if (part.normals) normal = part.normal_matrix * vector(*part.normals);
    add(normal.norm() > 0 ? normal.normalized() : normal, part.cloud.normals);
  }

  /// The inverse transpose up to a factor: the cofactors.
  static Eigen::Matrix3d normal_matrix(const Eigen::Matrix3d& m, bool mirrored) {
    Eigen::Matrix3d cofactors;
    cofactors << m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1));
    return mirrored ? Eigen::Matrix3d(-cofactors) : cofactors;
  }

  const Input& input_;
  const JsonNode& root_;
  GltfBuffers buffers_;
  std::vector<JsonNode> nodes_, meshes_;
  std::vector<Place> places_;      ///< output index by the vertex of the part
  std::vector<std::size_t> used_;  ///< used vertices of the part
  std::uint64_t num_parts_ = 0, num_corners_ = 0;
  Cloud triangles_, loose_;
  bool triangle_normals_ = true, loose_normals_ = true;  ///< all primitives have normals so far
};

}  // namespace

Result<Cloud> read_gltf(const Input& input) {
  TRIVET_TRY_ASSIGN(const auto parts, split_gltf(input));
  Cloud cloud;
  TRIVET_TRY(with_json(parts.json, input.file.string(), [&](const JsonNode& root) {
    cloud = GltfReader(input, root, parts.binary).read();
  }));
  return cloud;
}

}  // namespace trivet::formats
