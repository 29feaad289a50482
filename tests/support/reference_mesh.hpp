/// Slow reference implementations of mesh properties.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "storage/data/mesh.hpp"
#include "support/reference_model.hpp"

namespace trivet::reference {

inline std::array<std::uint32_t, 3> corners(const Mesh& mesh, std::size_t t) {
  return {mesh.triangles.a[t], mesh.triangles.b[t], mesh.triangles.c[t]};
}

/// Number of edges that are in only one triangle. No edge may be in more than two, nor twice in one
/// direction.
inline std::size_t count_open_edges(const Triangles& triangles) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> directed;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::array c{triangles.a[t], triangles.b[t], triangles.c[t]};
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_TRUE(directed.emplace(c[k], c[(k + 1) % 3]).second) << "two triangles on one side";
  }
  return static_cast<std::size_t>(std::ranges::count_if(directed, [&](const auto& edge) {
    return !directed.contains({edge.second, edge.first});
  }));
}

/// Whether every edge is in two triangles, in opposite directions, the triangles about each vertex
/// are one fan, and every vertex is in use.
inline testing::AssertionResult is_closed_manifold(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = c[k], to = c[(k + 1) % 3];
      if (from >= mesh.vertices.size() || from == to)
        return testing::AssertionFailure() << "triangle " << t << " is none";
      ++edges[{from, to}];
      next[from][to] = c[(k + 2) % 3];
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count != 1 || back == edges.end())
      return testing::AssertionFailure() << "edge " << edge.first << " - " << edge.second;
  }
  for (std::size_t v = 0; v < next.size(); ++v) {
    if (next[v].empty()) return testing::AssertionFailure() << "vertex " << v << " is not used";
    std::size_t turned = 0;
    const std::uint32_t first = next[v].begin()->first;
    std::uint32_t at = first;
    do at = next[v][at];
    while (++turned < next[v].size() && at != first);
    if (turned != next[v].size() || at != first)
      return testing::AssertionFailure() << "vertex " << v << " has several fans";
  }
  return testing::AssertionSuccess();
}

/// Vertices - edges + triangles of a closed mesh: 2 - 2 genus for each piece.
inline int euler_characteristic(const Mesh& mesh) {
  return static_cast<int>(mesh.vertices.size()) - static_cast<int>(mesh.triangles.size()) / 2;
}

inline std::size_t num_pieces(const Mesh& mesh) {
  std::vector<std::uint32_t> piece(mesh.vertices.size());
  for (std::uint32_t v = 0; v < piece.size(); ++v) piece[v] = v;
  const auto find = [&](std::uint32_t v) {
    while (piece[v] != v) v = piece[v] = piece[piece[v]];
    return v;
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh, t);
    piece[find(c[0])] = find(c[1]);
    piece[find(c[1])] = find(c[2]);
  }
  std::set<std::uint32_t> roots;
  for (std::uint32_t v = 0; v < piece.size(); ++v) roots.insert(find(v));
  return roots.size();
}

/// Volume of a closed mesh, positive for outward winding.
inline double volume(const Mesh& mesh) {
  double six_volumes = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    six_volumes += corner(mesh.vertices, mesh.triangles.a, t)
                       .dot(corner(mesh.vertices, mesh.triangles.b, t)
                                .cross(corner(mesh.vertices, mesh.triangles.c, t)));
  }
  return six_volumes / 6;
}

inline double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                  const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double length = along.squaredNorm();
  const double share = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0;
  return (p - a - share * along).norm();
}

/// Distance from a point to the nearest point on any triangle.
inline double distance_to_mesh(const Eigen::Vector3d& p, const Mesh& mesh) {
  double nearest = kInfinity;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d a = corner(mesh.vertices, mesh.triangles.a, t);
    const Eigen::Vector3d b = corner(mesh.vertices, mesh.triangles.b, t);
    const Eigen::Vector3d c = corner(mesh.vertices, mesh.triangles.c, t);
    if ((p - a).norm() - std::max((b - a).norm(), (c - a).norm()) >= nearest) continue;
    const Eigen::Vector3d n = (b - a).cross(c - a);
    const bool above = (b - a).cross(p - a).dot(n) >= 0 && (c - b).cross(p - b).dot(n) >= 0 &&
                       (a - c).cross(p - c).dot(n) >= 0 && n.norm() > 0;
    nearest = std::min(nearest,
                       above ? std::abs((p - a).dot(n.normalized()))
                             : std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c),
                                         distance_to_segment(p, c, a)}));
  }
  return nearest;
}

}  // namespace trivet::reference
