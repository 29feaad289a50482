/// Mean point distance of a mesh or a cloud: the unit in which the literature states noise.
#pragma once

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// The mean length of a mesh's edges, each counted once; 0 without triangles.
///
/// vertices    positions
/// triangles   indices < vertices.size()
/// Cost: n log n. Allocates once, for the list of the edges.
/// Source: the mesh resolution of Guo et al., IJCV 2013.
double mean_edge_length(PointsView vertices, const Triangles& triangles);

/// The mean distance of a cloud's points to their nearest neighbors; 0 for fewer than two points.
///
/// points   finite positions
/// Cost: n log n. Errors: bad_data (a point is not finite), no_memory.
Result<double> mean_neighbor_distance(PointsView points);

}  // namespace trivet::kernels
