/// Share of boundary edges of a mesh.
#pragma once

#include "storage/data/cloud.hpp"

namespace trivet::kernels {

/// The share of edges that belong to one triangle only: 0 for a closed surface, 1 if no triangles
/// share an edge. Meshes that repeat vertices instead of sharing them appear open. 0 without
/// triangles. Cost: sorts the edges; allocates once.
double boundary_share(const Triangles& triangles);

}  // namespace trivet::kernels
