/// Find the rigid motions that map a model onto itself.
#pragma once

#include "kernels/symmetry/sampled_surface.hpp"
#include "kernels/symmetry/turn_screen.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Find the rotations that map a surface onto itself; mirror images are no rigid motions.
///
/// surface    2000 to 4000 samples serve well; with fewer, symmetries of fine parts are missed; below
///            200 none is found
/// screen     of the surface
/// tolerance  RMS distance from the surface that a symmetry may leave, as a share of the diameter;
///            0.5 % is what scans, facets and scanned products leave. Beside it at most 2 % of the
///            surface may be off by three and 0.25 % by six tolerances: a handle or key breaks the
///            symmetry although the rest keeps it. A wrong symmetry would hide wrong poses, so
///            doubtful ones are left out.
/// Returns one of
///   - nothing: `trivial()`;
///   - the motions of a finite group without the identity: cyclic of order up to 64, dihedral,
///     or of a tetrahedron, octahedron, icosahedron;
///   - an axis with any turn about it, and the turn that swaps its ends where that is one, too;
///   - for a sphere, of which any rotation is a symmetry and no list holds all: an axis and
///     motions that take it to 128 directions spread evenly: every rotation is within 12 degrees of
///     one of them and a turn.
/// Deterministic. Cost: 20 to 100 ms on one core, 250 for an icosahedron.
///
/// Method: the axes of all symmetries pass through the centroid, and every finite group has
/// elements of prime order. Turns of order 2, 3 and 5 about a grid of axes, and of larger prime
/// order about the principal axes of inertia (the axis of a group with order above 5 is one), are
/// rated on a coarse distance field; the best are refined and verified on the samples, extended to
/// the full order of their axis and closed under composition. Every motion of the result has been
/// verified.
Symmetry find_symmetry(const SampledSurface& surface, const TurnScreen& screen,
                       float tolerance = 0.005F);

}  // namespace trivet::kernels
