/// Simulated scans with known ground truth: a model moved, thinned and disturbed by stated amounts.
#pragma once

#include <cstdint>
#include <span>

#include "storage/data/mesh.hpp"
#include "storage/data/model.hpp"

namespace trivet::bench {

struct Degradation {
  const char* name;
  float noise = 0;          ///< standard deviation of x, y and z each [mesh resolutions]
  std::size_t divisor = 1;  // /< one of this many vertices is kept
};

/// The degradations of Guo et al., IJCV 2013.
std::span<const Degradation> degradations();

/// A pose that depends only on the seed: any rotation, and a shift.
Pose random_pose(std::uint64_t seed, float reach);

/// Moves a model, then thins it, then adds noise to the remaining vertices.
///
/// resolution  of the model: its mean edge length
/// Thinning removes the edges with the least effect on the shape (kernels/meshing/decimate_mesh).
Mesh degrade_mesh(const Mesh& model, const Degradation& how, float resolution,
                  const Pose& T_scene_model, std::uint64_t seed);

}  // namespace trivet::bench
