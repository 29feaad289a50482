/// Conversion of a solid to a closed triangle mesh.
#pragma once

#include "kernels/simulation/solid.hpp"
#include "storage/data/mesh.hpp"

namespace trivet::kernels {

/// Extract the surface of a solid.
///
/// solid  solid with finite bounds
/// cell   edge of the lattice's cells, > 0 [unit of the solid]. Parts thinner than a cell may be
///        lost, and gaps narrower than a cell closed; chamfers stay below some 0.3 cells. Flat
///        faces and the edges between them are exact, corners are within 0.1 cells
/// Returns a closed surface, wound outward: every edge is in two triangles, in opposite directions,
/// and the triangles about a vertex are one fan. Empty without volume.
/// Cost: a value of the solid for each lattice node within a few cells of the surface, 16 bytes for
/// each node of its bounds. Allocates.
///
/// Method: dual contouring (Ju, Losasso, Schaefer, Warren, SIGGRAPH 2002). Each cell that the
/// surface crosses gets a vertex at the best intersection of the planes of its crossings; each
/// crossed edge gets a quadrangle. Before, the set of inside nodes is made well-composed (Latecki,
/// CVIU 1995): no two of its nodes, nor two outside, touch across a diagonal only. Then the surface
/// is a manifold.
Mesh mesh_solid(const Solid& solid, float cell);

}  // namespace trivet::kernels
