/// Make a scan worse in known steps, to measure how recognition bears it.
#pragma once

#include <cstdint>

#include "engine/options/option.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"

namespace trivet {

enum class Subsampler : std::uint8_t {
  none,
  voxel_grid,
  approximate_voxel_grid,
  grid_minimum,
  local_maximum,
};

struct DegradeOptions {
  bool scattered = false;     ///< take the pixel grid away even if nothing else is done
  float noise = 0;            ///< normal, standard deviation of x, y and z each [resolution]
  float noise_diameters = 0;  ///< the same [diameter], independent of the other and beside it
  float ray_noise = 0;        ///< normal, along the line of sight [resolution]
  float shot_noise = 0;       ///< share of the points that land anywhere in the scan's box
  float keep = 1;             ///< share of the points that stay
  Subsampler subsampler = Subsampler::none;
  float cell = 0.02F;  ///< or radius of the subsampler [diameter]
  bool operator==(const DegradeOptions&) const = default;
};

template <>
std::span<const Choice> choices_of<Subsampler>();
template <>
std::span<const Option<DegradeOptions>> options_of<DegradeOptions>();

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const DegradeOptions& options);

/// Degrade a scan: noise along the line of sight, noise of all axes, shot noise, then fewer points,
/// at random and by the subsampler.
///
/// cloud     a scan, from the viewpoint that it holds; a whole surface would become one that is
///           seen from the origin
/// options   valid
/// diameter  that the options count in [unit of the cloud], > 0: the mean of the models looked for
/// seed      one of its own for each scene, or points of like index err alike in all of them
///
/// The resolution is the median distance between the points of neighboring pixels; of a mesh, the
/// mean length of its edges; of other clouds, the mean distance to the nearest neighbor. Whatever
/// is degraded becomes a cloud of scattered points: grid, camera, triangles and normals are gone,
/// the viewpoint stays, and is the origin where none was told. Without any degradation the cloud
/// stays as it is. Same bytes for any number of threads. Cost: O(n); n log n for the resolution of
/// a cloud without pixels.
/// Errors: bad_data (the resolution of a cloud with a point that is not finite), internal (out of
/// memory).
/// Source: Drost et al., CVPR 2010, section 5 (noise in diameters); Guo et al., IJCV 2013 (noise
/// in mesh resolutions, shot noise, fewer points).
Result<void> degrade_scene(Cloud& cloud, const DegradeOptions& options, float diameter,
                           std::uint64_t seed);

}  // namespace trivet
