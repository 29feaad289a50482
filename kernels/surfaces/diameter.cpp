#include "kernels/surfaces/diameter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr double kTolerance = 1e-6;  // relative tolerance of distances
constexpr std::uint32_t kLeafSize = 32;

/// Largest squared distance from one point to a run of points.
TRIVET_SIMD_CLONES
float farthest_squared(const Eigen::Vector3f& from, const PointsView& points) {
  const float px = from.x(), py = from.y(), pz = from.z();
  const auto [x, y, z] = points;
  const std::size_t n = points.size();
  // Non-negative floats compare as their bits; the compiler vectorizes the integer maximum.
  std::int32_t best = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
    best = std::max(best, std::bit_cast<std::int32_t>(dx * dx + dy * dy + dz * dz));
  }
  return std::bit_cast<float>(best);
}

std::size_t farthest_index(PointsView points, const Eigen::Vector3d& from) {
  std::size_t best = 0;
  double best_squared = -1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double squared = (points[i].cast<double>() - from).squaredNorm();
    if (squared > best_squared) {
      best_squared = squared;
      best = i;
    }
  }
  return best;
}

/// A run of points as seen from the center: all lie in the cone, within the radius.
struct Cell {
  Eigen::Vector3f axis = Eigen::Vector3f::UnitZ();
  float half_angle = 0;  // [rad]
  float radius = 0;
  std::uint32_t first = 0, count = 0;
  std::uint32_t children = 0;  // index of the first of two; 0 for a leaf
};

class Search {
 public:
  /// points are relative to the center and include both ends of every distance above `best`.
  Search(std::vector<Eigen::Vector3f> points, double best) : best_(best), cells_(1) {
    build(points, 0, 0, static_cast<std::uint32_t>(points.size()));
    sorted_.reserve(points.size());
    for (const Eigen::Vector3f& p : points) sorted_.push_back(p);
    visit(0, 0);
  }
  double best() const { return best_; }

 private:
  void build(std::span<Eigen::Vector3f> points, std::uint32_t cell, std::uint32_t first,
             std::uint32_t count) {
    const auto begin = points.begin() + first;
    const auto end = begin + count;
    cells_[cell] = bound(points.subspan(first, count));
    cells_[cell].first = first;
    cells_[cell].count = count;
    if (count <= kLeafSize) return;

    // Halve along the widest side of the bounding box.
    Eigen::AlignedBox3f box(*begin);
    for (auto p = begin; p != end; ++p) box.extend(*p);
    int side = 0;
    box.sizes().maxCoeff(&side);
    const std::uint32_t half = count / 2;
    std::nth_element(begin, begin + half, end,
                     [side](const auto& a, const auto& b) { return a[side] < b[side]; });

    const auto children = static_cast<std::uint32_t>(cells_.size());
    cells_[cell].children = children;
    cells_.resize(cells_.size() + 2);
    build(points, children, first, half);
    build(points, children + 1, first + half, count - half);
  }

  static Cell bound(std::span<const Eigen::Vector3f> points) {
    Cell cell;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const auto& p : points) {
      sum += p.stableNormalized();
      cell.radius = std::max(cell.radius, p.norm());
    }
    cell.axis = sum.norm() > 0 ? sum.normalized() : cell.axis;
    for (const auto& p : points) {
      cell.half_angle = std::max(cell.half_angle, angle(cell.axis, p));
    }
    return cell;
  }

  /// Angle between two vectors; 0 if one is zero, which is harmless: its radius is zero too.
  static float angle(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }

  /// Upper bound of the distance between a point of one cell and a point of the other.
  static double upper_bound(const Cell& a, const Cell& b) {
    const double widest = std::min<double>(
        std::numbers::pi, 1e-6 + angle(a.axis, b.axis) + a.half_angle + b.half_angle);
    const double ra = a.radius, rb = b.radius;
    const double squared = ra * ra + rb * rb - 2 * ra * rb * std::cos(widest);
    // The law of cosines is convex in each radius: the largest value is at a full or a zero radius.
    return std::sqrt(std::max({squared, ra * ra, rb * rb}));
  }

  void visit(std::uint32_t i, std::uint32_t j) {
    const Cell& a = cells_[i];
    const Cell& b = cells_[j];
    if (upper_bound(a, b) <= best_ * (1 + kTolerance)) return;
    if (a.children == 0 && b.children == 0) return compare(a, b);
    if (i == j) {
      visit(a.children, a.children + 1);
      visit(a.children, a.children);
      visit(a.children + 1, a.children + 1);
    } else if (b.children == 0 || (a.children != 0 && a.count >= b.count)) {
      visit(a.children, j);
      visit(a.children + 1, j);
    } else {
      visit(i, b.children);
      visit(i, b.children + 1);
    }
  }

  void compare(const Cell& a, const Cell& b) {
    const PointsView others = sorted_.view().slice(b.first, b.count);
    float squared = 0;
    for (std::uint32_t i = a.first; i < a.first + a.count; ++i)
      squared = std::max(squared, farthest_squared(sorted_[i], others));
    best_ = std::max(best_, std::sqrt(static_cast<double>(squared)));
  }

  double best_;
  Points sorted_;
  std::vector<Cell> cells_;
};

}  // namespace

float find_diameter(PointsView points) {
  if (points.size() < 2) return 0;

  // Find a good initial distance: go to the farthest point repeatedly, while the distance grows.
  std::size_t end = farthest_index(points, points[0].cast<double>());
  double best = 0;
  Eigen::Vector3d center = points[end].cast<double>();
  for (int sweep = 0; sweep < 8; ++sweep) {
    const Eigen::Vector3d from = points[end].cast<double>();
    const std::size_t other = farthest_index(points, from);
    const double distance = (points[other].cast<double>() - from).norm();
    if (distance <= best) break;
    best = distance;
    center = 0.5 * (from + points[other].cast<double>());
    end = other;
  }
  if (best == 0) return 0;

  // An end of the diameter is at least best - r away from the center; r is the largest such
  // distance.
  const double radius = (points[farthest_index(points, center)].cast<double>() - center).norm();
  std::vector<Eigen::Vector3f> ends;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].cast<double>() - center;
    if (p.norm() + radius > best) ends.push_back(p.cast<float>());
  }
  if (ends.size() < 2) return static_cast<float>(best);
  return static_cast<float>(Search(std::move(ends), best).best());
}

}  // namespace trivet::kernels
