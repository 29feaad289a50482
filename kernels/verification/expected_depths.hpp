/// Depths that a sensor measures of a posed model whose depth images are smoothed.
#pragma once

#include "kernels/scans/range_image.hpp"
#include "kernels/verification/ray_crop.hpp"

namespace trivet::kernels {

/// Smooth a posed model's depth, and the measured depth around it, as the sensor's filter does.
///
/// hits       what the rays of the crop meet
/// smoothing  length of the filter [pixel], > 0: the exponential of two-sided recursive filters
/// scene      working memory
/// expected   smoothed depth of each ray that hits the model; infinite for the others
/// Measurements within the model's silhouette do not count, so that the depth does not depend on
/// what is compared with it. Steps of more than a tenth of the depth are kept.
/// Source: recursive edge-preserving filters of depth cameras, after Gastal and Oliveira, "Domain
/// transform for edge-aware image and video processing", SIGGRAPH 2011.
void expect_depths(const RangeImage& image, const RayCrop& crop, const RayHits& hits,
                   float smoothing, Column<float>& scene, Column<float>& expected);

}  // namespace trivet::kernels
