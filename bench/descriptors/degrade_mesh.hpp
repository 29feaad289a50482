/// Scans that are known exactly: a model moved, thinned and disturbed by a stated amount.
#pragma once

#include <cstdint>
#include <span>

#include "storage/data/mesh.hpp"
#include "storage/data/model.hpp"

namespace trivet::bench {

struct Degradation {
  const char* name;
  float noise = 0;          ///< standard deviation of x, y and z each [mesh resolutions]
  std::size_t divisor = 1;  ///< one in so many vertices is kept
};

/// Those of Guo et al., IJCV 2013.
std::span<const Degradation> degradations();

/// A pose that the seed alone decides: any rotation, and some way off.
Pose random_pose(std::uint64_t seed, float reach);

/// Move a model, then thin it, then disturb what is left.
///
/// resolution  of the model: its mean length of edges
/// Thinning takes the edges away that matter least to the shape (kernels/meshing/decimate_mesh).
Mesh degrade_mesh(const Mesh& model, const Degradation& how, float resolution,
                  const Pose& T_scene_model, std::uint64_t seed);

}  // namespace trivet::bench
