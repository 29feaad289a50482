#include "kernels/meshing/boundary_share.hpp"

#include <algorithm>
#include <cstdint>

#include "storage/common/stop.hpp"

namespace trivet::kernels {

double boundary_share(const Triangles& triangles) {
  Column<std::uint64_t> edges;
  edges.reserve(3 * triangles.size());
  const auto add = [&](std::uint32_t i, std::uint32_t j) {
    edges.push_back(static_cast<std::uint64_t>(std::min(i, j)) << 32 | std::max(i, j));
  };
  StopCheck check_stop(1 << 18);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    check_stop();
    add(triangles.a[t], triangles.b[t]);
    add(triangles.b[t], triangles.c[t]);
    add(triangles.c[t], triangles.a[t]);
  }
  std::sort(edges.begin(), edges.end(), [&](std::uint64_t a, std::uint64_t b) {
    check_stop();
    return a < b;
  });
  std::size_t num_edges = 0, num_boundary = 0;
  for (auto first = edges.begin(); first != edges.end();) {
    const auto last =
        std::find_if(first, edges.end(), [&](std::uint64_t edge) { return edge != *first; });
    ++num_edges;
    num_boundary += last - first == 1;
    first = last;
  }
  return num_edges > 0 ? static_cast<double>(num_boundary) / static_cast<double>(num_edges) : 0;
}

}  // namespace trivet::kernels
