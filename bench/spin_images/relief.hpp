/// The input of the descriptor rows: a bumpy surface, its keypoints, and the fraction of features
/// of a noisy scan that match the right positions.
#pragma once

#include <benchmark/benchmark.h>

#include "descriptors/feature_pool.hpp"
#include "descriptors/keypoint_surface.hpp"
#include "kernels/common/pca.hpp"

namespace trivet::bench {

inline constexpr std::size_t kNumKeypoints = 1000;

/// A relief of 22,500 vertices and some 1,000 of its vertices, in mesh resolutions of 1.
const KeypointSurface& relief();
/// The same keypoints on a scan of the relief: moved, with noise of 0.3 resolutions on each
/// coordinate.
const KeypointSurface& noisy_relief();

/// Tri-Spin-Images of the relief's and of the scan's keypoints.
const Column<float>& relief_images();
const Column<float>& noisy_images();
/// 60 principal components of the relief's images.
const PcaBasis& relief_basis();

/// Adds the counter nearest_right: the fraction of the scan's keypoints whose nearest feature on
/// the relief is at the right position, within half a support.
void report_nearest_right(benchmark::State& state, const Column<float>& of_relief,
                          const Column<float>& of_scan);

}  // namespace trivet::bench
