/// Throw bodies on a pile, where they come to rest.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

/// A rigid body of even density.
struct Body {
  PointsView vertices;  ///< the surface [m]; valid while its owner lives
  const Triangles* triangles = nullptr;
  float diameter = 0;               ///< largest distance between two points [m]
  Eigen::Vector3f center{0, 0, 0};  ///< of mass [m]
  double gyration = 0;              ///< radius of gyration [m], about
};

/// Measure a surface that somebody else keeps: diameter, center of mass, radius of gyration. The
/// center is that of the volume, or of the area where the faces do not bound one.
Body make_body(PointsView vertices, const Triangles& triangles);

/// A body in a world whose ground is the plane z = 0, z up.
struct PlacedBody {
  std::uint32_t body = 0;  ///< index
  Pose T_world_body = Pose::Identity();
};

/// Half the inner width of a bin about the origin, along x and y [m]. Infinite: an open table.
using BinSize = Eigen::Vector2d;
inline const BinSize kTable = BinSize::Constant(std::numeric_limits<double>::infinity());

/// A bin that these bodies, dropped into it, fill about one layer high and more.
BinSize choose_bin(std::span<const Body> bodies, std::span<const std::uint32_t> order);

/// Drop bodies one after the other; each slides, rolls and topples on what already lies there until
/// gravity and friction hold each other.
///
/// bodies        each at least a triangle
/// order         which to drop, as indices
/// bin           walls, of any height; wider than each body's diameter
/// seed, stream  give the pile; another stream of one seed is another pile
/// Returns one a drop. Nothing enters anything, and each body touches what holds it, both to the
/// rounding of its coordinates (kernels::Pile). Bodies come from above and do not move again: none
/// slips under another or pushes it away.
std::vector<PlacedBody> pile_up(std::span<const Body> bodies, std::span<const std::uint32_t> order,
                                const BinSize& bin, std::uint64_t seed, std::uint64_t stream);

}  // namespace trivet::engine
