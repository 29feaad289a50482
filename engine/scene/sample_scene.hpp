/// Samples of a prepared scene for models of one size.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/scene/prepare_scene.hpp"
#include "kernels/common/voxel_hash.hpp"

namespace trivet::engine {

/// The scene sampled for models of one step; the same in all rounds of voting.
struct SceneSample {
  float step = 0;
  float largest_diameter = 0;  ///< diameter of the largest model
  Points points;
  Normals normals;
  Points edges;  ///< of faces that end above what is behind them
  Normals edge_directions;
};

/// Treatment of points on planes that are larger than the largest model.
enum class LargePlanes : std::uint8_t { left_out, kept };

/// Sample a scene at `step`.
SceneSample sample_scene(const PreparedScene& scene, float step, float largest_diameter,
                         LargePlanes large_planes = LargePlanes::left_out);

/// Whether a scene point lies on a marked pixel of some image, within `tolerance` of that pixel's
/// measurement.
///
/// explained  nonzero for marked pixels, images concatenated
bool is_explained(const PreparedScene& scene, std::span<const std::uint8_t> explained,
                  const Eigen::Vector3f& point, float tolerance);

/// Voting points for models of one step in one round: of surfaces, then of edges, with directions as
/// the normals of sides that the sensor does not see.
struct SceneLevel {
  float step = 0;
  Points points;
  Normals normals;
  std::vector<std::uint32_t> references;  ///< indices of the reference points on surfaces, rising
  kernels::VoxelHash grid;
};

/// Choose the voting points and the references among them. Points within a step of a marked pixel's
/// measurement are excluded.
///
/// explained  nonzero for marked pixels, images concatenated; empty: none
SceneLevel choose_voters(const PreparedScene& scene, const SceneSample& sample,
                         const VoteOptions& options, std::span<const std::uint8_t> explained = {});

}  // namespace trivet::engine
