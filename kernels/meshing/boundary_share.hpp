/// How open a mesh is.
#pragma once

#include "storage/data/cloud.hpp"

namespace trivet::kernels {

/// The share of the edges that belong to one triangle only: 0 for a closed surface, 1 for triangles
/// that share none. Meshes that repeat vertices instead of sharing them look open. 0 without
/// triangles. Cost: sorts the edges, in memory taken once.
double boundary_share(const Triangles& triangles);

}  // namespace trivet::kernels
