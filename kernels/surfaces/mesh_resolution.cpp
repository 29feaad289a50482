#include "kernels/surfaces/mesh_resolution.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "kernels/common/nearest_neighbors.hpp"

namespace trivet::kernels {

double mean_edge_length(PointsView vertices, const Triangles& triangles) {
  // An edge as one number, independent of its direction.
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * triangles.size());
  const auto add = [&](std::uint64_t i, std::uint64_t j) {
    edges.push_back(std::min(i, j) << 32 | std::max(i, j));
  };
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    add(triangles.a[t], triangles.b[t]);
    add(triangles.b[t], triangles.c[t]);
    add(triangles.c[t], triangles.a[t]);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  if (edges.empty()) return 0;

  double sum = 0;
  for (const std::uint64_t edge : edges) {
    const auto end = [&](std::uint64_t i) { return vertices[i].cast<double>().eval(); };
    sum += (end(edge >> 32) - end(edge & 0xFFFFFFFF)).norm();
  }
  return sum / static_cast<double>(edges.size());
}

Result<double> mean_neighbor_distance(PointsView points) {
  if (points.size() < 2) return 0.0;
  TRIVET_TRY_ASSIGN(const NearestNeighbors tree, NearestNeighbors::build(points));
  // The nearest is the point itself, or another one at the same position.
  std::vector<std::uint32_t> indices(2 * points.size());
  std::vector<float> squared_distances(2 * points.size());
  TRIVET_TRY(tree.k_nearest(points, 2, indices, squared_distances));
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    sum += std::sqrt(static_cast<double>(squared_distances[2 * i + 1]));
  return sum / static_cast<double>(points.size());
}

}  // namespace trivet::kernels
