/// Even sampling of the surface of a mesh.
#pragma once

#include <cstdint>
#include <span>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Sum the areas of the triangles.
///
/// vertices   n positions [m]
/// triangles  m triples of indices < n
/// sums       m running sums [m^2]: sums[t] is the area of triangles 0..t; equal to the previous
///            one if a triangle has no area
/// Returns the total area [m^2], 0 for an empty mesh.
double sum_areas(PointsView vertices, const Triangles& triangles, std::span<double> sums);

/// A mesh to be sampled.
struct MeshSurface {
  PointsView vertices;  ///< positions [m]
  const Triangles& triangles;
  std::span<const double> area_sums;  ///< from `sum_areas`; the last one > 0
};

/// Write the samples first .. first + out.points.size() of a set of num_samples over the whole
/// surface.
///
/// seed  selects one of many equally good sets of samples
/// out   positions [m], each on a triangle, and as many unit face normals, by winding
/// Sample i represents the i-th of num_samples equal shares of the area, in the order of the
/// triangles; a triangle of k shares gets k samples to within two, spread evenly over it.
/// Sample i depends on seed, i and num_samples only: any split into chunks gives the same bits.
/// Cost: a binary search per sample. No allocation.
/// Source: stratified sampling; positions by the R2 sequence (Roberts, "The unreasonable
/// effectiveness of quasirandom sequences", 2018), mapped to the triangle by the map of Heitz ("A
/// low-distortion map between triangle and square", 2019).
void sample_mesh(const MeshSurface& surface, std::uint64_t seed, std::size_t first,
                 std::size_t num_samples, const OrientedSpan& out);

}  // namespace trivet::kernels
