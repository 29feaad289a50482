/// Building blocks of the families of parts.
#pragma once

#include <cstdint>
#include <numbers>

#include "kernels/common/counter_random.hpp"
#include "kernels/simulation/solid.hpp"
#include "storage/data/model.hpp"

namespace trivet::engine::parts {

using Eigen::Vector3f;
using kernels::CounterRandom;
using kernels::Solid;

/// A length beyond any part, for tools that cut through.
inline constexpr float kFar = 9;

/// A length or share between two bounds.
float between(CounterRandom& random, float low, float high);
/// A random integer from first to last.
std::uint32_t count_between(CounterRandom& random, std::uint32_t first, std::uint32_t last);

/// A rod about the z axis, from low to high, with a chamfer at both ends.
Solid rod(float radius, float low, float high, float chamfer = 0);
/// A cone about the z axis, with radius r0 at z0 and r1 at z1 > z0.
Solid cone(float r0, float z0, float r1, float z1);
/// An infinite regular prism about z; a flat faces +x at this distance.
Solid hexagon(float half_width);
Solid block(const Vector3f& low, const Vector3f& high);
/// The space from z = low to high.
Solid slab(float low, float high);
/// An infinite slot along z: a disc of this radius moved from (x0, y) to (x1, y).
Solid slot(float radius, float x0, float x1, float y);

/// What drilling along z at (x, y) takes off.
Solid hole(float radius, float x, float y);

Solid shifted(const Solid& solid, float x, float y, float z);
/// Turn a solid so that its z axis is along x (and its x axis along -z), or along y (and y along
/// -z).
Solid along_x(const Solid& solid);
Solid along_y(const Solid& solid);

Symmetry no_symmetry();
/// Symmetry under n equal turns about z.
Symmetry turns(std::uint32_t n);
/// Symmetry under these, and under half turns about x and n - 1 more axes in the plane z = 0.
Symmetry turns_and_flips(std::uint32_t n);
/// Symmetry under any turn about z; with `flip`, also under half turns about x.
Symmetry any_turn(bool flip);
/// Symmetry under the half turn about x.
Symmetry half_turn_x();

}  // namespace trivet::engine::parts
