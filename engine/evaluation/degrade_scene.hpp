/// Controlled degradation of a scan, to measure the robustness of recognition.
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
  bool scattered = false;     ///< whether to remove the pixel grid even without other degradations
  float noise = 0;            ///< normal noise, standard deviation of x, y and z each [resolution]
  float noise_diameters = 0;  ///< additional independent normal noise [diameter]
  float ray_noise = 0;        ///< normal noise along the line of sight [resolution]
  float shot_noise = 0;       ///< share of the points moved to random places in the scan's box
  float keep = 1;             ///< share of the points to keep
  Subsampler subsampler = Subsampler::none;
  float cell = 0.02F;  ///< edge of the cells or radius of the subsampler [diameter]
  bool operator==(const DegradeOptions&) const = default;
};

template <>
std::span<const Choice> choices_of<Subsampler>();
template <>
std::span<const Option<DegradeOptions>> options_of<DegradeOptions>();

/// Check the options. Errors: usage (names the option, its range and its value).
Result<void> validate(const DegradeOptions& options);

/// Degrade a scan: noise along the line of sight, noise of all axes, shot noise, then fewer points,
/// at random and by the subsampler.
///
/// cloud     a scan with its viewpoint; a whole surface would become one that is seen from the
///           origin
/// options   valid
/// diameter  unit of the options [unit of the cloud], > 0: the mean of the models to search for
/// seed      different for each scene; otherwise points with the same index have the same errors
///
/// The resolution is the median distance between the points of neighboring pixels; for a mesh, the
/// mean length of its edges; for other clouds, the mean distance to the nearest neighbor. A
/// degraded scan becomes a cloud of scattered points without grid, camera, triangles and normals.
/// It keeps its viewpoint, or receives the origin if it had none. Without any degradation the cloud
/// does not change. Same bytes for any number of threads. Cost: O(n); n log n for the resolution of
/// a cloud without pixels.
/// Errors: bad_data (the resolution of a cloud with a point that is not finite), internal (out of
/// memory).
/// Source: Drost et al., CVPR 2010, section 5 (noise in diameters); Guo et al., IJCV 2013 (noise in
/// mesh resolutions, shot noise, fewer points).
Result<void> degrade_scene(Cloud& cloud, const DegradeOptions& options, float diameter,
                           std::uint64_t seed);

}  // namespace trivet
