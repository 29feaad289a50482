/// Bodies on a table or in a bin, and the first contact of another body that descends from above.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// A contact, or near contact, between a body and its support.
struct Contact {
  Eigen::Vector3d point, normal;  ///< normal: unit vector from the support to the body
  double gap = 0;                 ///< approximate gap along the normal, >= 0 [m]
};

/// The ground z = 0, walls around it, and bodies on it as triangles. The space above a body's upper
/// side counts as free: no body slips under another.
class Pile {
 public:
  /// Working memory of `land`; avoids repeated allocation.
  struct Scratch;

  /// half_side  the bodies lie within |x|, |y| <= half_side [m]; outside is only the bare ground
  /// cell       > 0 [m], edge of the triangle lookup grid: affects the time only
  /// walls      walls stand at |x| = walls.x and |y| = walls.y [m], of any height; infinite: none
  Pile(double half_side, double cell, const Eigen::Vector2d& walls);

  /// Add a body at its present position. Cost: O(all triangles of the pile).
  void add(PointsView vertices, const Triangles& triangles);

  /// Find the shift that moves a body between the walls and into contact with the pile from above.
  ///
  /// vertices, triangles  the body; its indices are < vertices.size()
  /// reach                >= 0 [m]
  /// contacts             out: places where the shifted body is within `reach` above the pile or of
  ///                      a wall, at most a few hundred, spread over it; includes the touching ones
  /// Returns the shift [m]: horizontal only if a wall requires it, then vertical. The body touches
  /// but does not penetrate anything, up to rounding of its coordinates. The vertical clearance of
  /// two triangle surfaces is least at a corner of one over the other or where two edges cross; all
  /// of these are tested, least bound first, until no other can be lower.
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

  /// Steps of `land`. low, high: corners of the body's box; shift: of the body, [m].
  Eigen::Vector3d between_walls(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const;
  /// Write where the clearance may be below `limit` into scratch.candidates.
  void find_candidates(PointsView vertices, const Triangles& triangles,
                       const Eigen::Vector3d& shift, double limit, Scratch& scratch) const;
  /// The least clearance among the candidates and `clearance`, that of the ground. Places less than
  /// `reach` above the least one are written to scratch.touches, with others.
  double find_clearance(PointsView vertices, const Triangles& triangles,
                        const Eigen::Vector3d& shift, double reach, double clearance,
                        Scratch& scratch) const;

  double half_side_, cell_;
  Eigen::Vector2d walls_;
  std::ptrdiff_t side_;
  double highest_ = 0;
  std::vector<Facet> facets_;
  std::vector<double> top_;  // side_ * side_: upper bound of height; below the ground: bare
  std::vector<std::uint32_t> offsets_;  // CSR: the facets over each cell
  std::vector<std::uint32_t> indices_;
};

struct Pile::Scratch {
  struct Candidate {
    double bound;  // lower bound of the clearance in this cell
    std::uint32_t triangle, cell;
  };
  struct Touch {
    Eigen::Vector3d point, normal;
    double clearance, slant;  // their product is the gap
  };
  std::vector<Candidate> candidates;
  std::vector<Touch> touches;
  std::vector<std::uint32_t> buckets;
};

}  // namespace trivet::kernels
