/// Meshes of polygons and outlines with known areas, as found in files.
#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

namespace trivet::test {

using Outline2d = std::vector<Eigen::Vector2d>;

/// Signed area by the shoelace formula: positive for counterclockwise outlines.
inline double shoelace(const Outline2d& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d &p = outline[i], &q = outline[(i + 1) % outline.size()];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return twice / 2;
}

/// A gear with four corners per tooth.
inline Outline2d gear_outline(int teeth, double inner = 1, double outer = 1.25) {
  Outline2d outline;
  for (int i = 0; i < 4 * teeth; ++i) {
    const double angle = 2 * std::numbers::pi * i / (4 * teeth);
    const double radius = i % 4 < 2 ? outer : inner;
    outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return outline;
}

/// An outline with a hole, in the usual form of writers: from corner `at` over a bridge to the
/// hole, around it, and back over the bridge. The hole runs clockwise.
inline Outline2d bridged(const Outline2d& outline, std::size_t at, const Outline2d& hole) {
  Outline2d all(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(at) + 1);
  all.insert(all.end(), hole.begin(), hole.end());
  all.push_back(hole.front());
  all.insert(all.end(), outline.begin() + static_cast<std::ptrdiff_t>(at), outline.end());
  return all;
}

struct PolygonMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::vector<std::uint32_t>> faces;

  std::string obj() const {
    std::string text;
    for (const auto& v : vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
    for (const auto& face : faces) {
      text += "f";
      for (const auto i : face) text += fmt::format(" {}", i + 1);
      text += "\n";
    }
    return text;
  }
  std::string off() const {
    return fmt::format("OFF\n{} {} 0\n", vertices.size(), faces.size()) + rows_of_vertices() +
           rows_of_faces();
  }
  std::string ply(bool faces_first = false) const {
    const std::string vertex =
        fmt::format("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n",
                    vertices.size());
    const std::string face =
        fmt::format("element face {}\nproperty list int int vertex_indices\n", faces.size());
    return "ply\nformat ascii 1.0\n" + (faces_first ? face + vertex : vertex + face) +
           "end_header\n" +
           (faces_first ? rows_of_faces() + rows_of_vertices()
                        : rows_of_vertices() + rows_of_faces());
  }

 private:
  std::string rows_of_vertices() const {
    std::string text;
    for (const auto& v : vertices) text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
    return text;
  }
  std::string rows_of_faces() const {
    std::string text;
    for (const auto& face : faces) {
      text += fmt::format("{}", face.size());
      for (const auto i : face) text += fmt::format(" {}", i);
      text += "\n";
    }
    return text;
  }
};

/// A counterclockwise outline extruded from z = 0 to `height`. Its ends are one polygon each; or,
/// for outlines that are star-shaped about the origin, triangles about the origin.
inline PolygonMesh extruded(const Outline2d& outline, double height, bool triangulated = false) {
  PolygonMesh mesh;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {0.0, height}) {
    for (const Eigen::Vector2d& p : outline)
      mesh.vertices.push_back(Eigen::Vector3d(p.x(), p.y(), z).cast<float>());
  }
  std::vector<std::uint32_t> bottom, top;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.faces.push_back({i, j, n + j, n + i});
    bottom.push_back(n - 1 - i);
    top.push_back(n + i);
  }
  if (!triangulated) {
    mesh.faces.insert(mesh.faces.end(), {bottom, top});
    return mesh;
  }
  mesh.vertices.emplace_back(0, 0, 0);
  mesh.vertices.emplace_back(0, 0, static_cast<float>(height));
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.faces.push_back({bottom[i], bottom[j], 2 * n});
    mesh.faces.push_back({top[i], top[j], 2 * n + 1});
  }
  return mesh;
}

}  // namespace trivet::test
