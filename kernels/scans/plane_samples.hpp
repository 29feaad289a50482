/// The pixels of a range image that its planes are searched in.
#pragma once

#include <vector>

#include "kernels/scans/range_image.hpp"

namespace trivet::kernels {

struct PlaneSamples {
  Points points;             ///< in the camera's frame, file units
  Normals normals;           ///< of unit length
  std::vector<float> areas;  ///< of the surface that each stands for, in square file units
  float total_area = 0;
};

/// Take some 6,000 pixels of a grid over the image, those that have a depth and a normal.
/// Cost: the pixels. Takes memory.
PlaneSamples sample_for_planes(const RangeImage& image);

}  // namespace trivet::kernels
