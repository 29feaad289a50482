/// The common input of every descriptor: one surface, one set of keypoints, one set of normals.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "storage/data/mesh.hpp"
#include "storage/data/points.hpp"

namespace trivet::bench {

struct KeypointSurface {
  Mesh mesh;
  Points points;             // /< spread over the mesh, about one per squared resolution
  std::vector<float> areas;  // /< area represented by each point
  Points keypoints;          ///< vertices of the mesh
  Normals keypoint_normals;  ///< outward, if the mesh's winding is
  float radius = 0;          ///< of the supports
};

inline constexpr float kSupport = 15;  ///< radius of a support [mesh resolutions]

/// Samples a mesh evenly and estimates the normals of some of its vertices.
///
/// keypoints   indices of vertices
/// resolution  > 0; that of the model, even if the mesh is a scan of it
/// Samples are thinned by voxel and normal to one per resolution, as in recognition. Normals are
/// those of planes fitted to the samples within four resolutions, oriented like the faces.
KeypointSurface sample_surface(Mesh mesh, std::span<const std::uint32_t> keypoints,
                               float resolution);

/// This many random vertices of triangles, in ascending order; all, if there are fewer.
std::vector<std::uint32_t> draw_vertices(const Mesh& mesh, std::size_t count, std::uint64_t seed);

}  // namespace trivet::bench
