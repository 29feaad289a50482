/// Bodies that lie on a table or in a bin: where another one that comes down from above first
/// touches.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Where a body touches, or nearly touches, what holds it.
struct Contact {
  Eigen::Vector3d point, normal;  ///< normal: unit, from what holds to the body
  double gap = 0;                 ///< along the normal, about, >= 0 [m]
};

/// The ground z = 0, walls about it, and bodies on it as triangles. Whatever is above a body's
/// upper side is free: no body slips under another.
class Pile {
 public:
  /// What `land` works with; it only saves taking the memory anew.
  struct Scratch;

  /// half_side  the bodies lie within |x|, |y| <= half_side [m]; what is outside meets the bare
  ///            ground
  /// cell       > 0 [m], edge of the grid that triangles are looked up in: changes the time only
  /// walls      walls stand at |x| = walls.x and |y| = walls.y [m], of any height; infinite: none
  Pile(double half_side, double cell, const Eigen::Vector2d& walls);

  /// Let a body lie where it is. Cost: O(all triangles of the pile).
  void add(PointsView vertices, const Triangles& triangles);

  /// Find how to shift a body so that it stands between the walls and touches the pile from above.
  ///
  /// vertices, triangles  the body; its indices are < vertices.size()
  /// reach                >= 0 [m]
  /// contacts             out: where the shifted body is within `reach` above the pile or of a
  ///                      wall, at most a few hundred, spread over it; the touching ones among them
  /// Returns the shift [m]: horizontal only if a wall asks for it, then vertical. The body touches
  /// and enters nothing, but for the rounding of its coordinates: the clearance of two surfaces of
  /// triangles over the plane is least at a corner of one over the other or where two edges cross;
  /// all of these are looked at, least bound first, until no other can be lower.
  Eigen::Vector3d land(PointsView vertices, const Triangles& triangles, double reach,
                       Scratch& scratch, std::vector<Contact>& contacts) const;

 private:
  struct Cells {
    std::ptrdiff_t u0, u1, v0, v1;  // inclusive
  };
  using Facet = Eigen::Matrix3d;  // columns: corners

  Cells cells_under(const Facet& facet) const noexcept;
  template <class Visit>
  void for_cells_under(const Facet& facet, double sign, Visit&& visit) const;

  /// The steps of `land`. low, high: corners of the body's box; shift: of the body, [m].
  Eigen::Vector3d between_walls(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const;
  /// Write where the clearance may be below `limit` into scratch.candidates.
  void find_candidates(PointsView vertices, const Triangles& triangles,
                       const Eigen::Vector3d& shift, double limit, Scratch& scratch) const;
  /// The least clearance among the candidates and `clearance`, that of the ground. Places where it
  /// is less than `reach` above the least one go into scratch.touches, others among them.
  double find_clearance(PointsView vertices, const Triangles& triangles,
                        const Eigen::Vector3d& shift, double reach, double clearance,
                        Scratch& scratch) const;

  double half_side_, cell_;
  Eigen::Vector2d walls_;
  std::ptrdiff_t side_;
  double highest_ = 0;
  std::vector<Facet> facets_;
  std::vector<double> top_;             // side_ * side_: bound from above; below the ground: bare
  std::vector<std::uint32_t> offsets_;  // CSR: the facets over each cell
  std::vector<std::uint32_t> indices_;
};

struct Pile::Scratch {
  struct Candidate {
    double bound;  // no lower clearance in this cell
    std::uint32_t triangle, cell;
  };
  struct Touch {
    Eigen::Vector3d point, normal;
    double clearance, slant;  // gap: their product
  };
  std::vector<Candidate> candidates;
  std::vector<Touch> touches;
  std::vector<std::uint32_t> buckets;
};

}  // namespace trivet::kernels
