#include "kernels/meshing/triangulate_grid.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;
using GridCorners = std::array<std::int32_t, 3>;

constexpr double kNoiseSigmas = 3;  // standard deviations of noise tolerated for an edge or slope

/// Tests triangles from the sensor's viewpoint.
class Judge {
 public:
  Judge(PointsView points, const Eigen::Vector3f& viewpoint, std::span<const float> noise,
        const GridTriangulationOptions& options)
      : points_(points),
        viewpoint_(viewpoint.cast<double>()),
        noise_(noise),
        max_jump_(options.max_jump),
        max_slope_(std::tan(options.max_grazing_deg * std::numbers::pi / 180)) {}

  /// Position of a point relative to the viewpoint.
  Vector3d sight(std::int32_t i) const {
    return points_[static_cast<std::size_t>(i)].cast<double>() - viewpoint_;
  }
  bool is_finite(std::int32_t i) const { return i != PixelGrid::kNone && sight(i).allFinite(); }

  /// Twice the triangle's area as seen by the sensor, times its distance: positive for the front.
  double signed_area(const GridCorners& c) const {
    const Vector3d a = sight(c[0]);
    return -(sight(c[1]) - a).cross(sight(c[2]) - a).dot(a);
  }

  /// Whether two pixels are farther apart than their footprint and the noise allow.
  bool jumps(std::int32_t i, std::int32_t j) const {
    const Vector3d a = sight(i), b = sight(j);
    const double length = (b - a).squaredNorm(), along = b.norm() - a.norm();
    const double footprint = std::max(0.0, length - along * along);
    if (length <= max_jump_ * max_jump_ * footprint) return false;  // regardless of noise
    return !(std::sqrt(length) <= max_jump_ * std::sqrt(footprint) + slack(i, j));
  }

  /// Whether a triangle slopes away from the sensor more than the options and the noise allow.
  bool grazes(const GridCorners& c) const {
    const Vector3d a = sight(c[0]), b = sight(c[1]), d = sight(c[2]);
    const Vector3d to_sensor = -(a + b + d);
    const Vector3d normal = (b - a).cross(d - a);
    const double across = normal.dot(to_sensor);
    const double along = normal.cross(to_sensor).squaredNorm();
    if (!(across > 0)) return true;
    if (along <= max_slope_ * max_slope_ * across * across) return false;  // regardless of noise
    // The root of twice the visible area is the footprint.
    const double distance = to_sensor.norm();
    const double noise = std::max({slack(c[0], c[1]), slack(c[1], c[2]), slack(c[2], c[0])});
    return !(std::sqrt(along) <= max_slope_ * across + noise * std::sqrt(across * distance));
  }

 private:
  /// Possible contribution of noise to the difference of two ranges.
  double slack(std::int32_t i, std::int32_t j) const {
    const double a = noise_[static_cast<std::size_t>(i)], b = noise_[static_cast<std::size_t>(j)];
    return kNoiseSigmas * std::sqrt(a * a + b * b);
  }

  PointsView points_;
  Vector3d viewpoint_;
  std::span<const float> noise_;
  double max_jump_, max_slope_;
};

/// Call visit(corners) for each triangle between neighboring pixels, all with the same winding in
/// the image.
template <class Visit>
void visit_triangles(const PixelGrid& grid, const Judge& judge, Visit&& visit) {
  for (std::size_t v = 0; v + 1 < grid.height; ++v) {
    const std::int32_t* const row = &grid.point_index[v * grid.width];
    for (std::size_t u = 0; u + 1 < grid.width; ++u) {
      // The corners in order around the square.
      const std::array<std::int32_t, 4> p{row[u], row[grid.width + u], row[grid.width + u + 1],
                                          row[u + 1]};
      std::size_t num_empty = 0, empty = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        if (judge.is_finite(p[k])) continue;
        ++num_empty;
        empty = k;
      }
      if (num_empty > 1) continue;
      if (num_empty == 1) {
        visit(GridCorners{p[(empty + 1) % 4], p[(empty + 2) % 4], p[(empty + 3) % 4]});
        continue;
      }
      const bool odd = (judge.sight(p[3]) - judge.sight(p[1])).squaredNorm() <
                       (judge.sight(p[2]) - judge.sight(p[0])).squaredNorm();
      visit(odd ? GridCorners{p[0], p[1], p[3]} : GridCorners{p[0], p[1], p[2]});
      visit(odd ? GridCorners{p[1], p[2], p[3]} : GridCorners{p[2], p[3], p[0]});
    }
  }
}

}  // namespace

Triangles triangulate_grid(const PixelGrid& grid, PointsView points,
                           const Eigen::Vector3f& viewpoint, std::span<const float> noise,
                           const GridTriangulationOptions& options, GridTriangulationStats* stats) {
  TRIVET_REQUIRE(grid.point_index.size() == std::size_t{grid.width} * grid.height,
                 "one entry a pixel");
  TRIVET_REQUIRE(noise.size() == points.size(), "one value a point");
  const Judge judge(points, viewpoint, noise, options);

  // All triangles get the winding with which most of them face the sensor. One that then faces away
  // is seen from behind, which is impossible for a surface; reversing it alone would disconnect it
  // from its neighbors.
  std::int64_t balance = 0;
  visit_triangles(grid, judge, [&](const GridCorners& c) {
    const double signed_area = judge.signed_area(c);
    balance += (signed_area > 0) - (signed_area < 0);
  });
  const bool mirrored = balance < 0;

  GridTriangulationStats count;
  Triangles triangles;
  visit_triangles(grid, judge, [&](GridCorners c) {
    if (mirrored) std::swap(c[1], c[2]);
    if (judge.jumps(c[0], c[1]) || judge.jumps(c[1], c[2]) || judge.jumps(c[2], c[0])) {
      ++count.num_jumps;
    } else if (judge.signed_area(c) < 0) {
      ++count.num_behind;
    } else if (judge.grazes(c)) {
      ++count.num_grazing;
    } else {
      triangles.push_back(static_cast<std::uint32_t>(c[0]), static_cast<std::uint32_t>(c[1]),
                          static_cast<std::uint32_t>(c[2]));
    }
  });
  if (stats != nullptr) *stats = count;
  return triangles;
}

}  // namespace trivet::kernels
