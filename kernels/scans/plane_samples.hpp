/// Sampled pixels of a range image for plane detection.
#pragma once

#include <vector>

#include "kernels/scans/range_image.hpp"

namespace trivet::kernels {

struct PlaneSamples {
  Points points;             ///< in the camera's frame, file units
  Normals normals;           ///< unit normals
  std::vector<float> areas;  ///< area of the surface per sample, in square file units
  float total_area = 0;
};

/// Sample some 6,000 pixels with a depth and a normal on a grid over the image.
/// Cost: the pixels. Allocates.
PlaneSamples sample_for_planes(const RangeImage& image);

}  // namespace trivet::kernels
