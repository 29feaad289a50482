#include "kernels/meshing/delaunay.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>
#include <vector>

namespace trivet::kernels {
namespace {

using Place = std::array<std::int32_t, 3>;  // position on the lattice
__extension__ using Int128 = __int128;      // the predicates stay below 2^121

constexpr std::int32_t kSteps = 1 << 20;
// A tetrahedron that contains the lattice, at least its size away.
constexpr std::array<Place, 4> kFarCorners{{{-kSteps, -kSteps, -kSteps},
                                            {7 * kSteps, -kSteps, -kSteps},
                                            {-kSteps, 7 * kSteps, -kSteps},
                                            {-kSteps, -kSteps, 7 * kSteps}}};
// Error bound of a determinant of integers below 2^24, computed in double, relative to the sum of
// its products' magnitudes: far above the at most 20 roundings of 2^-53 on any path.
constexpr double kRounding = 1e-14;

template <class Number>
Number det3(const std::array<std::array<Number, 3>, 3>& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

int sign_of(Int128 value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

template <class Number>
std::array<Number, 3> difference(const Place& q, const Place& p) {
  return {static_cast<Number>(q[0] - p[0]), static_cast<Number>(q[1] - p[1]),
          static_cast<Number>(q[2] - p[2])};
}

/// Positive if d lies on the side of a, b, c to which (b - a) x (c - a) points.
int orientation(const Place& a, const Place& b, const Place& c, const Place& d) {
  const std::array<std::array<double, 3>, 3> m{difference<double>(b, a), difference<double>(c, a),
                                               difference<double>(d, a)};
  const auto length = [](const std::array<double, 3>& v) {
    return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]);
  };
  const double det = det3(m);
  if (std::abs(det) > kRounding * length(m[0]) * length(m[1]) * length(m[2]))
    return det > 0 ? 1 : -1;
  return sign_of(
      det3<Int128>({difference<Int128>(b, a), difference<Int128>(c, a), difference<Int128>(d, a)}));
}

/// det of the rows (q - p, |q - p|^2), and the sum of the magnitudes of its products.
template <class Number>
Number det_lifted(const std::array<std::array<Number, 3>, 4>& r, double& magnitude) {
  std::array<Number, 4> lifted;
  for (std::size_t i = 0; i < 4; ++i)
    lifted[i] = r[i][0] * r[i][0] + r[i][1] * r[i][1] + r[i][2] * r[i][2];
  const auto minor = [&](std::size_t i, std::size_t j) {
    return r[i][0] * r[j][1] - r[i][1] * r[j][0];
  };
  const Number ab = minor(0, 1), bc = minor(1, 2), cd = minor(2, 3), da = minor(3, 0),
               ac = minor(0, 2), bd = minor(1, 3);
  const Number abc = r[0][2] * bc - r[1][2] * ac + r[2][2] * ab;
  const Number bcd = r[1][2] * cd - r[2][2] * bd + r[3][2] * bc;
  const Number cda = r[2][2] * da + r[3][2] * ac + r[0][2] * cd;
  const Number dab = r[3][2] * ab + r[0][2] * bd + r[1][2] * da;
  if constexpr (std::is_same_v<Number, double>) {
    // Each |det of three rows| <= the product of their lengths; rounding errors scale with the
    // latter.
    std::array<double, 4> length;
    for (std::size_t i = 0; i < 4; ++i) length[i] = std::sqrt(lifted[i]);
    magnitude = length[0] * length[1] * length[2] * length[3] *
                (length[0] + length[1] + length[2] + length[3]);
  }
  return (lifted[3] * abc - lifted[2] * dab) + (lifted[1] * cda - lifted[0] * bcd);
}

/// Whether p lies strictly inside the circumsphere of a positively oriented tetrahedron.
bool in_ball(const Place& a, const Place& b, const Place& c, const Place& d, const Place& p) {
  double magnitude = 0;
  const double det = det_lifted<double>({difference<double>(a, p), difference<double>(b, p),
                                         difference<double>(c, p), difference<double>(d, p)},
                                        magnitude);
  if (std::abs(det) > kRounding * magnitude) return det < 0;
  return det_lifted<Int128>({difference<Int128>(a, p), difference<Int128>(b, p),
                             difference<Int128>(c, p), difference<Int128>(d, p)},
                            magnitude) < 0;
}

/// Interleave the lowest 21 bits of a coordinate with two zeros each.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x001F00000000FFFFU;
  x = (x | x << 16) & 0x001F0000FF0000FFU;
  x = (x | x << 8) & 0x100F00F00F00F00FU;
  x = (x | x << 4) & 0x10C30C30C30C30C3U;
  return (x | x << 2) & 0x1249249249249249U;
}

/// A point to be inserted into the triangulation.
struct Entry {
  int round;           // 0 first; a round has about as many points as all before it
  std::uint64_t code;  // position on the space-filling curve (Morton); unique per place
  std::uint32_t index;

  bool operator<(const Entry& other) const {
    if (round != other.round) return round < other.round;
    return code != other.code ? code < other.code : index < other.index;
  }
};

class Insertion {
 public:
  explicit Insertion(std::size_t num_places) {
    places_.resize(num_places);
    places_.insert(places_.end(), kFarCorners.begin(), kFarCorners.end());
    const auto n = static_cast<std::uint32_t>(num_places);
    tetrahedra_.reserve(7 * num_places + 64);
    tetrahedra_.push_back(
        {{n, n + 1, n + 2, n + 3},
         {Tetrahedron::kNone, Tetrahedron::kNone, Tetrahedron::kNone, Tetrahedron::kNone}});
    visited_.assign(1, Tetrahedron::kNone);
  }

  void insert(std::uint32_t v, const Place& place) {
    places_[v] = place;
    find_cavity(v);
    fill_cavity(v);
  }

  Column<Tetrahedron> release() { return std::move(tetrahedra_); }

 private:
  struct Face {
    std::uint32_t tetrahedron, corner;  // the face opposite this corner
  };

  const Place& place(const Tetrahedron& t, std::size_t k) const { return places_[t.corner[k]]; }

  /// Walk towards a position, from the tetrahedron created last.
  std::uint32_t locate(const Place& p) const {
    std::uint32_t at = last_, from = Tetrahedron::kNone;
    for (;;) {
      const Tetrahedron& t = tetrahedra_[at];
      std::uint32_t next = Tetrahedron::kNone;
      for (std::size_t k = 0; k < 4 && next == Tetrahedron::kNone; ++k) {
        if (t.across[k] == Tetrahedron::kNone || t.across[k] == from) continue;
        std::array<const Place*, 4> c{&place(t, 0), &place(t, 1), &place(t, 2), &place(t, 3)};
        c[k] = &p;
        if (orientation(*c[0], *c[1], *c[2], *c[3]) < 0) next = t.across[k];
      }
      if (next == Tetrahedron::kNone) return at;
      from = at;
      at = next;
    }
  }

  bool conflicts(std::uint32_t t, const Place& p) const {
    const Tetrahedron& tetrahedron = tetrahedra_[t];
    return in_ball(place(tetrahedron, 0), place(tetrahedron, 1), place(tetrahedron, 2),
                   place(tetrahedron, 3), p);
  }

  /// Gather the tetrahedra whose circumspheres contain the new position, and the faces around them.
  /// With ties outside, no face is coplanar with the position.
  void find_cavity(std::uint32_t v) {
    const Place& p = places_[v];
    cavity_.assign(1, locate(p));
    rim_.clear();
    visited_[cavity_[0]] = v;
    for (std::size_t i = 0; i < cavity_.size(); ++i) {
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t next = tetrahedra_[cavity_[i]].across[k];
        if (next != Tetrahedron::kNone && visited_[next] == v) continue;
        if (next != Tetrahedron::kNone && conflicts(next, p)) {
          visited_[next] = v;
          cavity_.push_back(next);
        } else {
          rim_.push_back({cavity_[i], k});
        }
      }
    }
  }

  /// Connect the position to every face around the cavity.
  void fill_cavity(std::uint32_t v) {
    const auto first_new = static_cast<std::uint32_t>(tetrahedra_.size());
    for (std::size_t i = 0; i < rim_.size(); ++i) {
      const Face& face = rim_[i];
      const auto made = static_cast<std::uint32_t>(tetrahedra_.size());
      Tetrahedron t = tetrahedra_[face.tetrahedron];
      const std::uint32_t outside = t.across[face.corner];
      t.corner[face.corner] = v;
      tetrahedra_.push_back(t);
      if (outside != Tetrahedron::kNone)
        *std::ranges::find(tetrahedra_[outside].across, face.tetrahedron) = made;
      tetrahedra_[face.tetrahedron].across[face.corner] = made;  // for turn() below
    }
    for (std::size_t i = 0; i < rim_.size(); ++i) {
      for (std::uint32_t k = 0; k < 4; ++k) {
        if (k == rim_[i].corner) continue;
        tetrahedra_[first_new + i].across[k] = turn(rim_[i], k, first_new);
      }
    }
    reuse();
  }

  /// Rotate through the old tetrahedra about the edge of a face opposite corner k, to the new
  /// tetrahedron at the other end.
  std::uint32_t turn(const Face& face, std::uint32_t k, std::uint32_t first_new) const {
    std::uint32_t at = face.tetrahedron, pivot = tetrahedra_[at].corner[face.corner];
    for (;;) {
      const std::uint32_t next = tetrahedra_[at].across[k];
      if (next >= first_new) return next;
      const Tetrahedron& t = tetrahedra_[next];
      const auto entered =
          static_cast<std::size_t>(std::ranges::find(t.across, at) - t.across.begin());
      k = static_cast<std::uint32_t>(std::ranges::find(t.corner, pivot) - t.corner.begin());
      pivot = t.corner[entered];
      at = next;
    }
  }

  /// Fill the slots of the old tetrahedra, from the highest on, with the last ones.
  void reuse() {
    visited_.resize(tetrahedra_.size(), Tetrahedron::kNone);
    std::ranges::sort(cavity_, std::greater());
    for (const std::uint32_t gap : cavity_) {
      const auto moved = static_cast<std::uint32_t>(tetrahedra_.size() - 1);
      if (gap != moved) {
        for (const std::uint32_t next : tetrahedra_[moved].across)
          if (next != Tetrahedron::kNone) *std::ranges::find(tetrahedra_[next].across, moved) = gap;
        tetrahedra_[gap] = tetrahedra_[moved];
        visited_[gap] = Tetrahedron::kNone;
      }
      tetrahedra_.pop_back();
    }
    visited_.resize(tetrahedra_.size());
    last_ = std::min(cavity_[0], static_cast<std::uint32_t>(tetrahedra_.size() - 1));
  }

  std::vector<Place> places_;
  Column<Tetrahedron> tetrahedra_;
  std::vector<std::uint32_t> visited_;  // per tetrahedron: the position whose cavity contained it
  std::uint32_t last_ = 0;
  std::vector<std::uint32_t> cavity_;
  std::vector<Face> rim_;
};

}  // namespace

Delaunay find_delaunay(PointsView points) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].cast<double>();
    if (p.allFinite()) box.extend(p);
  }
  const double extent = std::max(box.sizes().maxCoeff(), std::numeric_limits<double>::min());

  std::vector<Entry> entries;
  entries.reserve(points.size());
  const auto place_of = [&](std::size_t i) {
    const Eigen::Vector3d p =
        ((points[i].cast<double>() - box.min()) * (kSteps / extent)).array().round();
    return Place{static_cast<std::int32_t>(p.x()), static_cast<std::int32_t>(p.y()),
                 static_cast<std::int32_t>(p.z())};
  };
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    const Place p = place_of(i);
    const std::uint64_t code = spread_bits(static_cast<std::uint64_t>(p[0])) |
                               spread_bits(static_cast<std::uint64_t>(p[1])) << 1 |
                               spread_bits(static_cast<std::uint64_t>(p[2])) << 2;
    // The round is drawn from the position alone, so that the order of the points does not matter.
    std::uint64_t hash = (code + 0x9E3779B97F4A7C15U) * 0xBF58476D1CE4E5B9U;
    hash = (hash ^ hash >> 29) * 0x94D049BB133111EBU;
    entries.push_back({-std::countr_zero(hash >> 32 | std::uint64_t{1} << 20), code, i});
  }
  std::sort(entries.begin(), entries.end());

  Delaunay delaunay;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i == 0 || entries[i].code != entries[i - 1].code)
      delaunay.places.push_back(entries[i].index);
  }
  Insertion insertion(delaunay.places.size());
  for (std::uint32_t v = 0; v < delaunay.places.size(); ++v)
    insertion.insert(v, place_of(delaunay.places[v]));
  delaunay.tetrahedra = insertion.release();
  for (std::size_t k = 0; k < 4; ++k) {
    const Place& far = kFarCorners[k];
    delaunay.far_corners[k] = box.min() + extent / kSteps * Eigen::Vector3d(far[0], far[1], far[2]);
  }
  return delaunay;
}

}  // namespace trivet::kernels
