#include "storage/formats/used_vertices.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace trivet {
namespace {

constexpr double kLowest = 1e-6;  // smallest ratio of height to the longest side

bool has_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  return ab.cross(ac).norm() > kLowest * longest;
}

}  // namespace

UsedVertices find_used_vertices(PointsView vertices, TrianglesView triangles) {
  UsedVertices used;
  used.marks.resize(vertices.size());
  const auto at = [&](std::uint32_t i) { return vertices[i].cast<double>().eval(); };
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t a = triangles.a[t], b = triangles.b[t], c = triangles.c[t];
    if (has_area(at(a), at(b), at(c))) used.marks[a] = used.marks[b] = used.marks[c] = 1;
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (used.marks[triangles.a[t]] == 0 || used.marks[triangles.b[t]] == 0 ||
        used.marks[triangles.c[t]] == 0) {
      ++used.num_without_area;
    }
  }
  used.num_unused = static_cast<std::size_t>(std::ranges::count(used.marks, 0));
  return used;
}

}  // namespace trivet
