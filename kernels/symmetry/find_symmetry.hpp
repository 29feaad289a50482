/// Search for the symmetries of a model: rigid transforms that map it onto itself.
#pragma once

#include "kernels/symmetry/sampled_surface.hpp"
#include "kernels/symmetry/turn_screen.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Find the rotations that map a surface onto itself; mirror images are not rigid transforms.
///
/// surface    2000 to 4000 samples serve well; with fewer, symmetries of fine parts are missed;
///            below 200 none is found
/// screen     screen of the surface
/// tolerance  largest RMS distance from the surface for a symmetry, as a share of the diameter;
///            scans, facets and scanned products have errors of 0.5 %. In addition, at most 2 % of
///            the surface may be off by three and 0.25 % by six tolerances: a handle or key breaks
///            the symmetry although the rest keeps it. A wrong symmetry would hide wrong poses, so
///            doubtful ones are omitted.
/// Returns one of
///   - nothing: `trivial()`;
///   - the transforms of a finite group without the identity: cyclic of order up to 64, dihedral,
///     or that of a tetrahedron, octahedron or icosahedron;
///   - an axis of continuous rotation, and the rotation that swaps its ends if that is a symmetry,
///     too;
///   - for a sphere, which any rotation maps onto itself: an axis and transforms of it to 128
///     evenly spread directions. Every rotation is within 12 degrees of one of them combined with a
///     rotation about the axis.
/// Deterministic. Cost: 20 to 100 ms on one core, 250 for an icosahedron.
///
/// Method: the axes of all symmetries pass through the centroid, and every finite group has
/// elements of prime order. Rotations of order 2, 3 and 5 about a grid of axes, and of larger prime
/// order about the principal axes of inertia (the axis of a group with order above 5 is one), are
/// rated on a coarse distance field. The best are refined and verified on the samples, extended to
/// the full order of their axis and closed under composition. Every transform of the result has
/// been verified.
Symmetry find_symmetry(const SampledSurface& surface, const TurnScreen& screen,
                       float tolerance = 0.005F);

}  // namespace trivet::kernels
