/// Simulation of bodies dropped onto a pile.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

/// A rigid body of uniform density.
struct Body {
  PointsView vertices;  ///< vertices of the surface [m]; valid during its owner's lifetime
  const Triangles* triangles = nullptr;
  float diameter = 0;               ///< largest distance between two points [m]
  Eigen::Vector3f center{0, 0, 0};  ///< center of mass [m]
  double gyration = 0;              ///< radius of gyration about the center [m]
};

/// Measure the diameter, center of mass and radius of gyration of a surface, which the caller must
/// keep. The center is that of the volume, or of the area if the faces do not enclose a volume.
Body make_body(PointsView vertices, const Triangles& triangles);

/// A body in a world with the ground plane z = 0, z up.
struct PlacedBody {
  std::uint32_t body = 0;  ///< index
  Pose T_world_body = Pose::Identity();
};

/// Half the inner width of a bin about the origin, along x and y [m]. Infinite: an open table.
using BinSize = Eigen::Vector2d;
inline const BinSize kTable = BinSize::Constant(std::numeric_limits<double>::infinity());

/// A bin that these bodies fill at least about one layer high.
BinSize choose_bin(std::span<const Body> bodies, std::span<const std::uint32_t> order);

/// Drop bodies one after another. Each slides, rolls and topples on those that already lie there,
/// until gravity and friction balance.
///
/// bodies        each with at least one triangle
/// order         bodies to drop, as indices
/// bin           walls of any height; wider than each body's diameter
/// seed, stream  determine the pile; another stream of one seed gives another pile
/// Returns one placed body per drop. Bodies do not penetrate each other, and each touches its
/// supports, both to the rounding of its coordinates (kernels::Pile). Bodies come from above and do
/// not move again: none slips under another or pushes it away.
std::vector<PlacedBody> pile_up(std::span<const Body> bodies, std::span<const std::uint32_t> order,
                                const BinSize& bin, std::uint64_t seed, std::uint64_t stream);

}  // namespace trivet::engine
