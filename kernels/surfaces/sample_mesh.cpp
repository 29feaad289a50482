#include "kernels/surfaces/sample_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

/// Twice the area times the unit normal, in double: float would be too coarse for slivers.
Eigen::Vector3d scaled_normal(PointsView vertices, const Triangles& triangles, std::size_t t) {
  const Eigen::Vector3d a = vertices[triangles.a[t]].cast<double>();
  const Eigen::Vector3d b = vertices[triangles.b[t]].cast<double>();
  const Eigen::Vector3d c = vertices[triangles.c[t]].cast<double>();
  return (b - a).cross(c - a);
}

/// A number in [0, 1) from a counter (the finalizer of SplitMix64, Steele et al., OOPSLA 2014).
double uniform(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t x = seed + (counter + 1) * 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  x ^= x >> 31;
  return static_cast<double>(x >> 11) * 0x1p-53;
}

struct Corner {
  Eigen::Vector3d point, ab, ac;  ///< a corner, and the edges from it
  Eigen::Vector3f normal;
};

Corner first_corner(PointsView vertices, const Triangles& triangles, std::size_t t) {
  const Eigen::Vector3d a = vertices[triangles.a[t]].cast<double>();
  const Eigen::Vector3d ab = vertices[triangles.b[t]].cast<double>() - a;
  const Eigen::Vector3d ac = vertices[triangles.c[t]].cast<double>() - a;
  return {a, ab, ac, ab.cross(ac).normalized().cast<float>()};
}

double fraction(double x) { return x - std::floor(x); }

}  // namespace

double sum_areas(PointsView vertices, const Triangles& triangles, std::span<double> sums) {
  TRIVET_REQUIRE(sums.size() == triangles.size(), "one sum per triangle");
  double sum = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    sum += 0.5 * scaled_normal(vertices, triangles, t).norm();
    sums[t] = sum;
  }
  return sum;
}

void sample_mesh(const MeshSurface& surface, std::uint64_t seed, std::size_t first,
                 std::size_t num_samples, const OrientedSpan& out) {
  const std::span<const double> area_sums = surface.area_sums;
  const Triangles& triangles = surface.triangles;
  const PointsSpan points = out.points;
  const NormalsSpan normals = out.normals;
  TRIVET_REQUIRE(area_sums.size() == triangles.size(), "one sum per triangle");
  TRIVET_REQUIRE(!area_sums.empty() && area_sums.back() > 0,
                 "a surface without area has no samples");
  TRIVET_REQUIRE(normals.size() == points.size(), "one normal per point");
  TRIVET_REQUIRE(first + points.size() <= num_samples, "samples beyond the last");

  // The two constants of the R2 sequence: 1/g and 1/g^2 with g^3 = g + 1.
  constexpr double kStepU = 0.75487766624669276;
  constexpr double kStepV = 0.56984029099805327;
  const double shift_u = uniform(seed, ~0ULL - 1);
  const double shift_v = uniform(seed, ~0ULL - 2);
  const auto last = std::lower_bound(area_sums.begin(), area_sums.end(), area_sums.back());
  const double share = area_sums.back() / static_cast<double>(num_samples);

  // The triangle at a random position within each share. Positions ascend, and so do the triangles.
  const auto place_of = [&](std::size_t i) {
    return (static_cast<double>(i) + uniform(seed, i)) * share;
  };
  auto found = std::upper_bound(area_sums.begin(), last, place_of(first));
  const auto corner_at = [&](auto triangle) {
    return first_corner(surface.vertices, triangles,
                        static_cast<std::size_t>(triangle - area_sums.begin()));
  };
  Corner corner = corner_at(found);

  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::size_t i = first + k;
    const auto index = static_cast<double>(i);
    const double place = place_of(i);
    if (found != last && *found <= place) {
      do ++found;  // skip triangles without area
      while (found != last && *found <= place);
      corner = corner_at(found);
    }

    // Map from the square to the triangle that preserves areas and most neighborhoods.
    double u = fraction(shift_u + kStepU * index);
    double v = fraction(shift_v + kStepV * index);
    if (v > u) {
      u *= 0.5;
      v -= u;
    } else {
      v *= 0.5;
      u -= v;
    }
    points.set(k, (corner.point + u * corner.ab + v * corner.ac).cast<float>());
    normals.set(k, corner.normal);
  }
}

}  // namespace trivet::kernels
