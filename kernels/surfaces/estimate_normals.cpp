#include "kernels/surfaces/estimate_normals.hpp"

#include <limits>

#include "kernels/common/plane_fit.hpp"
#include "storage/common/precondition.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

// Sums about the row's first point: differences of close floats are exact or nearly so, and double
// keeps digits that a float sum would lose far from the origin.
PlaneSums sum_row(PointsView points, std::span<const std::uint32_t> row) {
  PlaneSums s{};
  if (row.empty()) return s;
  const double ox = points.x[row[0]], oy = points.y[row[0]], oz = points.z[row[0]];
  s.n = static_cast<double>(row.size());
  for (const std::uint32_t i : row) {
    const double x = points.x[i] - ox, y = points.y[i] - oy, z = points.z[i] - oz;
    s.x += x;
    s.y += y;
    s.z += z;
    s.xx += x * x;
    s.xy += x * y;
    s.xz += x * z;
    s.yy += y * y;
    s.yz += y * z;
    s.zz += z * z;
  }
  return s;
}

}  // namespace

void estimate_normals(PointsView points, NeighborhoodsView neighbors, NormalsSpan normals,
                      std::span<float> residuals) {
  TRIVET_REQUIRE(normals.size() == neighbors.size(), "one normal per neighborhood");
  TRIVET_REQUIRE(residuals.empty() || residuals.size() == normals.size(),
                 "one residual per normal");
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < neighbors.size(); ++i) {
    const PlaneFit plane = fit_plane(sum_row(points, neighbors.row(i)));
    const Eigen::Vector3d normal{plane.x, plane.y, plane.z};
    normals.set(i, plane.determined ? Eigen::Vector3f(normal.cast<float>())
                                    : Eigen::Vector3f::Constant(kNaN));
    if (!residuals.empty()) {
      residuals[i] = plane.determined ? static_cast<float>(plane.residual) : kNaN;
    }
  }
}

TRIVET_SIMD_CLONES
void orient_normals(PointsView points, const Eigen::Vector3f& viewpoint, NormalsSpan normals) {
  TRIVET_REQUIRE(normals.size() == points.size(), "one normal per point");
  const float vx = viewpoint.x(), vy = viewpoint.y(), vz = viewpoint.z();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float towards = normals.x[i] * (vx - points.x[i]) + normals.y[i] * (vy - points.y[i]) +
                          normals.z[i] * (vz - points.z[i]);
    const float sign = towards < 0 ? -1.0F : 1.0F;
    normals.x[i] *= sign;
    normals.y[i] *= sign;
    normals.z[i] *= sign;
  }
}

}  // namespace trivet::kernels
