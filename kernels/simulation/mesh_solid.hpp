/// Turn a solid into a closed surface of triangles.
#pragma once

#include "kernels/simulation/solid.hpp"
#include "storage/data/mesh.hpp"

namespace trivet::kernels {

/// Extract the surface of a solid.
///
/// solid  with finite bounds
/// cell   edge of the lattice's cells, > 0 [unit of the solid]. What is thinner than a cell may be
///        lost, gaps narrower than a cell closed; chamfers stay below some 0.3 cells;
///        flat faces and the edges between them are met, corners to 0.1 cells
/// Returns a closed surface, wound outward: every edge is in two triangles, in opposite directions,
/// and the triangles about a vertex are one fan. Without volume, nothing.
/// Cost: a value of the solid for each lattice node within a few cells of the surface, 16 bytes for
/// each node of its bounds. Takes memory.
///
/// Method: dual contouring (Ju, Losasso, Schaefer, Warren, SIGGRAPH 2002): a vertex in each cell
/// that the surface crosses, where the planes of its crossings meet best; a quadrangle about each
/// edge that it crosses. Before, the set of inside nodes is made well-composed (Latecki, CVIU
/// 1995): no two of its nodes, nor two outside, touch across a diagonal only. Then the surface is a
/// manifold.
Mesh mesh_solid(const Solid& solid, float cell);

}  // namespace trivet::kernels
