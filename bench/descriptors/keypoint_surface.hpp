/// What every descriptor is given: one surface, one set of keypoints, one set of normals.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "storage/data/mesh.hpp"
#include "storage/data/points.hpp"

namespace trivet::bench {

struct KeypointSurface {
  Mesh mesh;
  Points points;             ///< spread over the mesh, about one a resolution squared
  std::vector<float> areas;  ///< that each stands for
  Points keypoints;          ///< vertices of the mesh
  Normals keypoint_normals;  ///< outward, if the mesh's winding is
  float radius = 0;          ///< of the supports
};

inline constexpr float kSupport = 15;  ///< radius of a support [mesh resolutions]

/// Sample a mesh evenly and estimate the normals of some of its vertices.
///
/// keypoints   indices of vertices
/// resolution  > 0, the model's also where the mesh is a scan of it
/// Samples are thinned to one a resolution as recognition does: by voxel and normal. Normals are
/// those of planes fitted to the samples within four resolutions; their side is that of the faces.
KeypointSurface sample_surface(Mesh mesh, std::span<const std::uint32_t> keypoints,
                               float resolution);

/// So many vertices of triangles, drawn at random, rising; all, if there are fewer.
std::vector<std::uint32_t> draw_vertices(const Mesh& mesh, std::size_t count, std::uint64_t seed);

}  // namespace trivet::bench
