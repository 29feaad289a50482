/// Points of a known surface for meshing, and measures of how well a mesh agrees with it.
#pragma once

#include <benchmark/benchmark.h>

#include "parts.hpp"
#include "scan.hpp"
#include "storage/data/cloud.hpp"

namespace trivet::bench {

/// Random points on a sphere of radius 1 with their normals, moved along these by noise of 0.2
/// spacings; the same on every call.
const OrientedPoints& noisy_sphere(std::int64_t num_points);

/// Adds counters: triangles per point; the fraction of points used; the fractions of edges that are
/// open, that are in more than two triangles, and whose two triangles face opposite sides; and the
/// root mean square distance of the triangles' centroids from the sphere, in spacings.
void report_sphere(benchmark::State& state, const OrientedPoints& sphere,
                   const Triangles& triangles);

/// Adds the counters for any mesh: all of the above except the distance.
void report_mesh(benchmark::State& state, std::size_t num_points, const Triangles& triangles);

/// Adds these counters for the scan, and the number of triangles that bridge the step from the ball
/// to the walls.
void report_scan(benchmark::State& state, const Scan& scan, const Triangles& triangles);

inline constexpr std::int64_t kMeshPoints[] = {4096, 32768, 262144};
inline constexpr std::int64_t kMeshWidths[] = {160, 640};

}  // namespace trivet::bench
