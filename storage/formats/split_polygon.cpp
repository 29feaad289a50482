#include "storage/formats/split_polygon.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "storage/common/precondition.hpp"
#include "storage/common/stop.hpp"

namespace trivet::formats {
namespace {

using Corner = SplitScratch::Corner;

/// A fan covers its polygon if its triangles' areas add up to the polygon's, within this share.
/// Text files keep about six digits of a coordinate.
constexpr double kFanExcess = 1e-6;

/// Twice the signed area of a triangle.
double area_of(const Corner& a, const Corner& b, const Corner& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Project the polygon to the plane, counterclockwise; returns twice its area. Drops the axis
/// nearest to its normal: in the other two, corners that coincide or are aligned with an axis
/// remain exactly so. Normal: Newell's sum over the edges.
double lay_out(PointsView points, std::span<const std::uint32_t> indices,
               std::vector<Corner>& corners) {
  const Eigen::Vector3d first = points[indices[0]].cast<double>();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < indices.size(); ++i) {
    normal += (points[indices[i]].cast<double>() - first)
                  .cross(points[indices[i + 1]].cast<double>() - first);
  }
  Eigen::Index dropped = 0;
  normal.cwiseAbs().maxCoeff(&dropped);
  Eigen::Index right = (dropped + 1) % 3, up = (dropped + 2) % 3;
  if (normal[dropped] < 0) std::swap(right, up);

  const auto n = static_cast<std::uint32_t>(indices.size());
  corners.assign(n, {});
  for (std::uint32_t i = 0; i < n; ++i) {
    const Eigen::Vector3f p = points[indices[i]];
    corners[i] = {p[right], p[up], (i + n - 1) % n, (i + 1) % n, false, false};
  }
  return std::abs(normal[dropped]);
}

/// Twice the sum of the triangles' unsigned areas.
double covered_area(std::span<const Corner> corners, std::span<const CornerTriangle> triangles) {
  double sum = 0;
  for (const CornerTriangle& t : triangles) {
    sum += std::abs(area_of(corners[t.a], corners[t.b], corners[t.c]));
  }
  return sum;
}

void fan(std::span<CornerTriangle> out) {
  for (std::uint32_t i = 0; i < out.size(); ++i) out[i] = {0, i + 1, i + 2};
}

/// Cuts corners off an outline until a triangle is left. The triangles' signed areas always add up
/// to the polygon's, so they cover it exactly if none is inverted.
class EarClipper {
 public:
  EarClipper(SplitScratch& scratch, std::uint64_t& steps)
      : corners_(scratch.corners), waiting_(scratch.waiting), grid_(scratch.grid), steps_(steps) {
    double largest = 0;
    for (const Corner& c : corners_) largest = std::max({largest, std::abs(c.x), std::abs(c.y)});
    rounding_ = 4 * largest * std::numeric_limits<float>::epsilon();
    for (std::uint32_t i = 0; i < corners_.size(); ++i) judge(i);
    grid_.fill(std::span<const Corner>(corners_));
  }

  /// False if the steps did not suffice.
  bool clip(std::span<CornerTriangle> out) {
    // Numerical degeneracy and self-intersecting outlines may leave no ear: then the criterion is
    // relaxed.
    for (const Demand demand : {Demand::ear, Demand::rounded_ear, Demand::convex, Demand::none}) {
      if (!clip_while(demand, out)) return false;
    }
    TRIVET_REQUIRE(cut_ == out.size(), "the last demand is met by every corner");
    return true;
  }

 private:
  enum class Demand {
    ear,          ///< a triangle with no other corner in it, or exactly zero area
    rounded_ear,  ///< an ear within the rounding of the coordinates
    convex,       ///< a triangle that is not inverted
    none
  };

  bool clip_while(Demand demand, std::span<CornerTriangle> out) {
    waiting_.clear();
    for (std::uint32_t i = 0; i < corners_.size(); ++i) {
      if (!corners_[i].is_cut) waiting_.push_back(i);
    }
    // First in, first out: cutting adjacent corners in sequence would make slivers. A cut changes
    // only its neighbors, so only these are tested again.
    for (std::size_t k = 0; k < waiting_.size() && cut_ < out.size(); ++k) {
      check_stop();  // the test of one corner may visit all others
      const std::uint32_t tip = waiting_[k];
      if (corners_[tip].is_cut || !meets(demand, tip)) continue;
      if (steps_ == 0) return false;
      out[cut_++] = {corners_[tip].previous, tip, corners_[tip].next};
      cut(tip);
    }
    return steps_ > 0;
  }

  void cut(std::uint32_t tip) {
    const std::uint32_t previous = corners_[tip].previous, next = corners_[tip].next;
    corners_[tip].is_cut = true;
    corners_[previous].next = next;
    corners_[next].previous = previous;
    for (const std::uint32_t neighbor : {previous, next}) {
      judge(neighbor);
      waiting_.push_back(neighbor);
    }
  }

  void judge(std::uint32_t i) {
    Corner& corner = corners_[i];
    corner.is_reflex = !(area_of(corners_[corner.previous], corner, corners_[corner.next]) > 0);
  }

  bool meets(Demand demand, std::uint32_t tip) {
    const Corner& b = corners_[tip];
    const Corner &a = corners_[b.previous], &c = corners_[b.next];
    const double area = area_of(a, b, c);
    switch (demand) {
      case Demand::ear:
        return area > 0 ? is_empty(tip, 0) : area == 0 && reverses(a, b, c);
      case Demand::rounded_ear: {
        const double length = std::hypot(b.x - a.x, b.y - a.y) + std::hypot(c.x - b.x, c.y - b.y);
        return std::abs(area) <= rounding_ * length || (area > 0 && is_empty(tip, rounding_));
      }
      case Demand::convex:
        return area >= 0;
      case Demand::none:
        break;
    }
    return true;
  }

  static bool same_place(const Corner& a, const Corner& b) { return a.x == b.x && a.y == b.y; }

  /// Whether collinear corners repeat a position or reverse direction, as bridges do after their
  /// hole is filled; otherwise they continue straight.
  static bool reverses(const Corner& a, const Corner& b, const Corner& c) {
    return (a.x - b.x) * (c.x - b.x) + (a.y - b.y) * (c.y - b.y) >= 0;
  }

  /// Whether no corner lies in the triangle of this tip, by more than `margin` if that is above
  /// zero. If any does, a reflex one does. Corners at the triangle's own corners are the other ends
  /// of bridges and do not count.
  bool is_empty(std::uint32_t tip, double margin) {
    const Corner& b = corners_[tip];
    const Corner &a = corners_[b.previous], &c = corners_[b.next];
    const auto reach = [margin](const Corner& from, const Corner& to) {
      return margin * std::hypot(to.x - from.x, to.y - from.y);
    };
    const double ab = reach(a, b), bc = reach(b, c), ca = reach(c, a);
    const double low_x = std::min({a.x, b.x, c.x}), high_x = std::max({a.x, b.x, c.x});
    const double low_y = std::min({a.y, b.y, c.y}), high_y = std::max({a.y, b.y, c.y});
    const auto lies_outside = [&](const Corner& p) {
      if (p.is_cut || !p.is_reflex) return true;
      if (p.x < low_x || p.x > high_x || p.y < low_y || p.y > high_y) return true;
      if (same_place(p, a) || same_place(p, b) || same_place(p, c)) return true;
      const double pab = area_of(a, b, p), pbc = area_of(b, c, p), pca = area_of(c, a, p);
      const bool inside =
          margin > 0 ? pab > ab && pbc > bc && pca > ca : pab >= 0 && pbc >= 0 && pca >= 0;
      return !inside;
    };
    return grid_.visit({a.x, a.y}, {b.x, b.y}, {c.x, c.y}, [&](auto run) {
      const std::uint64_t num_visited = std::min<std::uint64_t>(steps_, run.size() + 1);
      steps_ -= num_visited;
      return num_visited > run.size() &&
             std::ranges::all_of(run, [&](std::uint32_t i) { return lies_outside(corners_[i]); });
    });
  }

  std::vector<Corner>& corners_;
  std::vector<std::uint32_t>& waiting_;
  CornerGrid& grid_;
  std::uint64_t& steps_;
  double rounding_ = 0;
  std::size_t cut_ = 0;
};

}  // namespace

bool split_polygon(PointsView points, std::span<const std::uint32_t> corners, SplitScratch& scratch,
                   std::uint64_t& steps, std::span<CornerTriangle> out) {
  TRIVET_REQUIRE(corners.size() >= 3 && out.size() == corners.size() - 2, "n - 2 triangles");
  const double area = lay_out(points, corners, scratch.corners);
  fan(out);
  const double of_fan = covered_area(scratch.corners, out);
  // True also without area and for non-finite corners.
  if (!(of_fan > (1 + kFanExcess) * area)) return true;

  const bool sufficed = EarClipper(scratch, steps).clip(out);
  if (!sufficed || !(covered_area(scratch.corners, out) < of_fan)) fan(out);
  return sufficed;
}

}  // namespace trivet::formats
