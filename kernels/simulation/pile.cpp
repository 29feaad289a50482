#include "kernels/simulation/pile.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Facet = Eigen::Matrix3d;

constexpr double kSlack = 1e-9;        // [m], tolerance for rounding in bounds and at the edges of
                                       // triangles
constexpr std::uint32_t kBuckets = 8;  // contacts are distributed over so many squared buckets

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

Vector3d upwards(const Vector3d& v) { return v.z() < 0 ? (-v).normalized() : v.normalized(); }

Facet corners(PointsView vertices, const Triangles& triangles, std::size_t t) {
  Facet facet;
  facet.col(0) = vertices[triangles.a[t]].cast<double>();
  facet.col(1) = vertices[triangles.b[t]].cast<double>();
  facet.col(2) = vertices[triangles.c[t]].cast<double>();
  return facet;
}

/// Height of a facet at a position that it covers.
bool height_above(const Facet& facet, const Vector3d& place, double& height) {
  const Vector2d a = facet.col(0).head<2>(), b = facet.col(1).head<2>(), c = facet.col(2).head<2>(),
                 p = place.head<2>();
  const double area = cross(b - a, c - a);
  const double sides = (b - a).cwiseAbs().maxCoeff() + (c - a).cwiseAbs().maxCoeff();
  if (std::abs(area) <= 1e-12 * sides * sides) return false;  // upright: its edges are tested
  const double u = cross(c - b, p - b) / area, v = cross(a - c, p - c) / area, w = 1 - u - v;
  if (std::min({u, v, w}) < -1e-9) return false;
  height = u * facet(2, 0) + v * facet(2, 1) + w * facet(2, 2);
  return true;
}

/// Call touch(point, normal, clearance, gap per clearance) at all candidates for the least
/// clearance between two facets.
template <class Touch>
void compare(const Facet& upper, const Facet& lower, Touch&& touch) {
  double height = 0;
  const auto on_face = [&](const Vector3d& p, const Vector3d& normal, double clearance) {
    const Vector3d up = upwards(normal);
    touch(p, up, clearance, up.z());
  };
  for (int i = 0; i < 3; ++i) {
    const Vector3d p = upper.col(i);
    if (!height_above(lower, p, height)) continue;
    on_face(p, (lower.col(1) - lower.col(0)).cross(lower.col(2) - lower.col(0)), p.z() - height);
  }
  for (int i = 0; i < 3; ++i) {
    const Vector3d p = lower.col(i);
    if (!height_above(upper, p, height)) continue;
    on_face(p, (upper.col(1) - upper.col(0)).cross(upper.col(2) - upper.col(0)), height - p.z());
  }
  for (int i = 0; i < 3; ++i) {
    const Vector3d a = upper.col(i), along = upper.col((i + 1) % 3) - a;
    for (int j = 0; j < 3; ++j) {
      const Vector3d b = lower.col(j), across = lower.col((j + 1) % 3) - b;
      const double turn = cross(along.head<2>(), across.head<2>());
      if (turn == 0) continue;  // side by side: their ends are tested
      const Vector2d between = (b - a).head<2>();
      const double s = cross(between, across.head<2>()) / turn,
                   t = cross(between, along.head<2>()) / turn;
      if (std::min(s, t) < 0 || std::max(s, t) > 1) continue;
      const Vector3d p = a + s * along;
      // The edge may lie within a flat face: then its normal holds only at the crossing, and
      // treated as a wall it would stop bodies in free space.
      touch(p, upwards(along.cross(across)), p.z() - (b.z() + t * across.z()), 1.0);
    }
  }
}

/// Columns and rows of the grid; -1 and `side` stand for outside.
struct Places {
  double half_side, cell;
  std::ptrdiff_t side;
  Vector3d shift;
  std::ptrdiff_t at(double coordinate) const noexcept {
    return static_cast<std::ptrdiff_t>(std::clamp((coordinate + half_side) / cell + 1, 0.0,
                                                  static_cast<double>(side) + 1)) -
           1;
  }
  std::ptrdiff_t column(float x, double slack) const noexcept {
    return at(static_cast<double>(x) + shift.x() + slack);
  }
  std::ptrdiff_t row(float y, double slack) const noexcept {
    return at(static_cast<double>(y) + shift.y() + slack);
  }
};

/// The x range of a facet where south <= y <= north; the minimum is larger if it is empty.
std::pair<double, double> across_strip(const Facet& facet, double south, double north) {
  double west = std::numeric_limits<double>::infinity(), east = -west;
  for (int i = 0; i < 3; ++i) {
    const Vector3d a = facet.col(i), b = facet.col((i + 1) % 3);
    if (std::max(a.y(), b.y()) < south || std::min(a.y(), b.y()) > north) continue;
    for (const double y : {south, north}) {
      const double from = a.y() - y, to = b.y() - y;
      if ((from < 0) == (to < 0)) continue;
      const double x = a.x() + (b.x() - a.x()) * from / (from - to);
      west = std::min(west, x);
      east = std::max(east, x);
    }
    for (const Vector3d* end : {&a, &b}) {
      if (end->y() < south || end->y() > north) continue;
      west = std::min(west, end->x());
      east = std::max(east, end->x());
    }
  }
  return {west, east};
}

/// Keeps only the nearest of many contacts at one position with similar normals.
class ContactSieve {
 public:
  /// low, high  corners of the body's box before the shift
  /// buckets    scratch
  /// contacts   output
  ContactSieve(const Vector3d& low, const Vector3d& high, const Vector3d& shift,
               std::vector<std::uint32_t>& buckets, std::vector<Contact>& contacts)
      : low_(low),
        shift_(shift),
        extent_((high - low).head<2>().cwiseMax(1e-9)),
        buckets_(buckets),
        contacts_(contacts) {
    buckets_.assign(std::size_t{kBuckets} * kBuckets * kDirections * kDirections, kNone);
  }

  void keep(const Vector3d& point, const Vector3d& normal, double gap) {
    const Vector2d place =
        ((point - shift_ - low_).head<2>().array() / extent_.array() * kBuckets).matrix();
    const auto part = [](double x, double parts) {
      return static_cast<std::size_t>(std::clamp(std::floor(x), 0.0, parts - 1));
    };
    const auto direction = [&](double x) { return part(2.5 * x + 2.5, kDirections); };
    const std::size_t bucket =
        ((part(place.y(), kBuckets) * kBuckets + part(place.x(), kBuckets)) * kDirections +
         direction(normal.x())) *
            kDirections +
        direction(normal.y());
    std::uint32_t& slot = buckets_[bucket];
    if (slot == kNone) {
      slot = static_cast<std::uint32_t>(contacts_.size());
      contacts_.push_back({point, normal, gap});
    } else if (gap < contacts_[slot].gap) {
      contacts_[slot] = {point, normal, gap};
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFF'FFFFU;
  static constexpr std::uint32_t kDirections = 5;  // directions of a normal along x, and along y
  Vector3d low_, shift_;
  Vector2d extent_;
  std::vector<std::uint32_t>& buckets_;
  std::vector<Contact>& contacts_;
};

}  // namespace

Pile::Pile(double half_side, double cell, const Vector2d& walls)
    : half_side_(half_side),
      cell_(cell),
      walls_(walls),
      side_(static_cast<std::ptrdiff_t>(std::ceil(2 * half_side / cell)) + 1) {
  TRIVET_REQUIRE(half_side > 0 && cell > 0, "a grid of some extent");
  top_.assign(static_cast<std::size_t>(side_ * side_), -1.0);
  offsets_.assign(top_.size() + 1, 0);
}

Pile::Cells Pile::cells_under(const Facet& facet) const noexcept {
  const Places places{half_side_, cell_, side_, Vector3d::Zero()};
  const Vector3d low = facet.rowwise().minCoeff(), high = facet.rowwise().maxCoeff();
  return {std::max<std::ptrdiff_t>(places.at(low.x() - kSlack), 0),
          std::min(places.at(high.x() + kSlack), side_ - 1),
          std::max<std::ptrdiff_t>(places.at(low.y() - kSlack), 0),
          std::min(places.at(high.y() + kSlack), side_ - 1)};
}

/// Call visit(cell, height) with an upper (sign 1) or lower (sign -1) bound of the facet's height
/// over the cell.
template <class Visit>
void Pile::for_cells_under(const Facet& facet, double sign, Visit&& visit) const {
  const Cells cells = cells_under(facet);
  const double extreme = sign > 0 ? facet.row(2).maxCoeff() : facet.row(2).minCoeff();
  if (cells.u0 >= cells.u1 && cells.v0 >= cells.v1) {
    if (cells.u0 == cells.u1 && cells.v0 == cells.v1) {
      visit(static_cast<std::size_t>(cells.v0 * side_ + cells.u0), extreme);
    }
    return;
  }
  const Vector3d normal = (facet.col(1) - facet.col(0)).cross(facet.col(2) - facet.col(0));
  const bool upright = std::abs(normal.z()) <= 1e-6 * normal.norm();
  const Vector2d slope = upright ? Vector2d(0, 0) : Vector2d(-normal.head<2>() / normal.z());
  const double within = slope.cwiseAbs().sum() * 0.5 * cell_ + kSlack;
  const Places places{half_side_, cell_, side_, Vector3d::Zero()};
  for (std::ptrdiff_t v = cells.v0; v <= cells.v1; ++v) {
    const double south = static_cast<double>(v) * cell_ - half_side_;
    const auto [west, east] = across_strip(facet, south - kSlack, south + cell_ + kSlack);
    const std::ptrdiff_t first = std::max(cells.u0, places.at(west - kSlack)),
                         last = std::min(cells.u1, places.at(east + kSlack));
    for (std::ptrdiff_t u = first; u <= last; ++u) {
      double bound = extreme;
      if (!upright) {
        const Vector2d middle((static_cast<double>(u) + 0.5) * cell_ - half_side_,
                              (static_cast<double>(v) + 0.5) * cell_ - half_side_);
        const double height =
            facet(2, 0) + slope.dot(middle - facet.col(0).head<2>()) + sign * within;
        bound = sign > 0 ? std::min(extreme, height) : std::max(extreme, height);
      }
      visit(static_cast<std::size_t>(v * side_ + u), bound);
    }
  }
}

void Pile::add(PointsView vertices, const Triangles& triangles) {
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    facets_.push_back(corners(vertices, triangles, t));
    highest_ = std::max(highest_, facets_.back().row(2).maxCoeff());
  }
  offsets_.assign(top_.size() + 1, 0);
  for (const Facet& facet : facets_) {
    for_cells_under(facet, 1, [&](std::size_t cell, double height) {
      ++offsets_[cell + 1];
      top_[cell] = std::max(top_[cell], height);
    });
  }
  for (std::size_t i = 1; i < offsets_.size(); ++i) offsets_[i] += offsets_[i - 1];
  indices_.resize(offsets_.back());
  std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    for_cells_under(facets_[f], 1, [&](std::size_t cell, double) {
      indices_[next[cell]++] = static_cast<std::uint32_t>(f);
    });
  }
}

Vector3d Pile::between_walls(const Vector3d& low, const Vector3d& high) const {
  Vector3d shift(0, 0, 0);
  for (int k = 0; k < 2; ++k)
    shift[k] = std::max(0.0, -walls_[k] - low[k]) + std::min(0.0, walls_[k] - high[k]);
  return shift;
}

void Pile::find_candidates(PointsView vertices, const Triangles& triangles, const Vector3d& shift,
                           double limit, Scratch& scratch) const {
  scratch.candidates.clear();
  const auto propose = [&](std::size_t t, std::size_t cell, double height) {
    const double bound = height - top_[cell] - kSlack;
    if (offsets_[cell] == offsets_[cell + 1] || bound >= limit) return;
    scratch.candidates.push_back(
        {bound, static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(cell)});
  };
  const Places places{half_side_, cell_, side_, shift};
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::size_t a = triangles.a[t], b = triangles.b[t], c = triangles.c[t];
    const float lowest = std::min({vertices.z[a], vertices.z[b], vertices.z[c]});
    if (static_cast<double>(lowest) - highest_ >= limit) continue;
    const auto [x0, x1] = std::minmax({vertices.x[a], vertices.x[b], vertices.x[c]});
    const auto [y0, y1] = std::minmax({vertices.y[a], vertices.y[b], vertices.y[c]});
    const std::ptrdiff_t u0 = places.column(x0, -kSlack), u1 = places.column(x1, kSlack),
                         v0 = places.row(y0, -kSlack), v1 = places.row(y1, kSlack);
    if (u1 - u0 > 1 || v1 - v0 > 1) {  // large: its slope gives a better bound than its lowest
                                       // corner
      const Facet facet = corners(vertices, triangles, t).colwise() + shift;
      for_cells_under(facet, -1,
                      [&](std::size_t cell, double height) { propose(t, cell, height); });
      continue;
    }
    for (std::ptrdiff_t v = std::max<std::ptrdiff_t>(v0, 0); v <= std::min(v1, side_ - 1); ++v) {
      for (std::ptrdiff_t u = std::max<std::ptrdiff_t>(u0, 0); u <= std::min(u1, side_ - 1); ++u) {
        propose(t, static_cast<std::size_t>(v * side_ + u), static_cast<double>(lowest));
      }
    }
  }
}

double Pile::find_clearance(PointsView vertices, const Triangles& triangles, const Vector3d& shift,
                            double reach, double clearance, Scratch& scratch) const {
  auto& candidates = scratch.candidates;
  auto& touches = scratch.touches;
  touches.clear();
  double best = clearance;
  // Cells by ascending bound, until none can be lower than the best found.
  const auto later = [](const Scratch::Candidate& a, const Scratch::Candidate& b) {
    return a.bound > b.bound;
  };
  std::make_heap(candidates.begin(), candidates.end(), later);
  while (!candidates.empty() && candidates.front().bound < best + reach) {
    const Scratch::Candidate candidate = candidates.front();
    std::pop_heap(candidates.begin(), candidates.end(), later);
    candidates.pop_back();
    const Facet upper = corners(vertices, triangles, candidate.triangle).colwise() + shift;
    const Vector3d from = upper.rowwise().minCoeff(), to = upper.rowwise().maxCoeff();
    for (std::uint32_t i = offsets_[candidate.cell]; i < offsets_[candidate.cell + 1]; ++i) {
      const Facet& lower = facets_[indices_[i]];
      const Vector3d lower_from = lower.rowwise().minCoeff(), lower_to = lower.rowwise().maxCoeff();
      if (lower_from.x() > to.x() + kSlack || lower_to.x() < from.x() - kSlack ||
          lower_from.y() > to.y() + kSlack || lower_to.y() < from.y() - kSlack ||
          from.z() - lower_to.z() >= best + reach) {
        continue;
      }
      compare(upper, lower,
              [&](const Vector3d& point, const Vector3d& normal, double apart, double slant) {
                if (apart >= best + reach) return;
                best = std::min(best, apart);
                touches.push_back({point, normal, apart, slant});
              });
    }
  }
  return best;
}

Vector3d Pile::land(PointsView vertices, const Triangles& triangles, double reach, Scratch& scratch,
                    std::vector<Contact>& contacts) const {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < vertices.size(); ++i) box.extend(vertices[i].cast<double>());
  const Vector3d& low = box.min();
  Vector3d shift = between_walls(low, box.max());
  find_candidates(vertices, triangles, shift, low.z() + reach, scratch);
  const double clearance = find_clearance(vertices, triangles, shift, reach, low.z(), scratch);
  shift.z() = -clearance;

  contacts.clear();
  ContactSieve sieve(low, box.max(), shift, scratch.buckets, contacts);
  for (const Scratch::Touch& touch : scratch.touches) {
    if (touch.clearance >= clearance + reach) continue;
    sieve.keep(touch.point + Vector3d(0, 0, shift.z()), touch.normal,
               (touch.clearance - clearance) * touch.slant);
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vector3d p = vertices[i].cast<double>() + shift;
    if (p.z() <= reach) sieve.keep(p, Vector3d::UnitZ(), std::max(0.0, p.z()));
    for (int k = 0; k < 2; ++k) {
      const double inwards = p[k] > 0 ? -1 : 1, gap = walls_[k] - std::abs(p[k]);
      if (gap <= reach) sieve.keep(p, inwards * Vector3d::Unit(k), std::max(0.0, gap));
    }
  }
  return shift;
}

}  // namespace trivet::kernels
