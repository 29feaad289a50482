/// Noise on the positions of a cloud, to measure the robustness of recognition.
///
/// The noise of a point depends on the seed and its index alone, and kinds of noise with one seed
/// are independent of each other. Pixels of an organized scan keep their points; only noise along
/// the viewing ray leaves a depth image's points on the rays of their pixels.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>

#include "storage/data/points.hpp"

namespace trivet::kernels {

// points   n positions; non-finite ones stay so
// first    index of points[0] in the whole cloud: rows are independent, and any split into chunks
//          gives the same bits
// out      n positions; may alias the points
// No allocation or lock.

/// Add normal noise of standard deviation `sigma` [unit of the points] to x, y and z each.
/// Source: Drost et al., CVPR 2010, section 5 (sigma as a share of the diameter); Guo et al., IJCV
/// 2013 (in mesh resolutions).
void add_gaussian_noise(PointsView points, float sigma, std::uint64_t seed, std::size_t first,
                        PointsSpan out);

/// Add normal noise of standard deviation `sigma` to the distance from the viewpoint, as a range
/// sensor does. A point at the viewpoint does not move.
void add_ray_noise(PointsView points, const Eigen::Vector3f& viewpoint, float sigma,
                   std::uint64_t seed, std::size_t first, PointsSpan out);

/// With probability `share`, move each point to a uniformly random position in the box, usually the
/// cloud's bounding box. The others keep their bits.
/// Source: the shot noise of Guo et al., IJCV 2013.
void add_shot_noise(PointsView points, const Eigen::AlignedBox3f& box, double share,
                    std::uint64_t seed, std::size_t first, PointsSpan out);

}  // namespace trivet::kernels
