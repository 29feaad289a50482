/// Occluding edges of a scan: where a face ends above what is behind it.
#pragma once

#include <cstddef>

#include "kernels/scans/range_image.hpp"
#include "kernels/scans/sensor_model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

struct OccludingEdgeOptions {
  const SensorModel& sensor;
  float nearest;   ///< smallest depth of the image, > 0 [scene unit]
  int window = 2;  ///< half-width of the windows for fitting normals [pixel], >= 1
};

/// Append the occluding edges of rows [first_row, first_row + num_rows): the last pixels of faces,
/// seen at less than 60 degrees, beyond which the scan falls back by more than the sensor errs.
///
/// points      places of those pixels, camera frame [scene unit]
/// directions  unit vectors in the face's plane, out of the face. The sensor does not see the side of
///             a plate or a box there; this is its normal
/// Rows are independent: any split into chunks gives the same bits. Cost: O(1) per pixel.
/// Source: after Drost, Ilic, 3DIMPVT 2012, who pair points of surfaces with depth edges.
void find_occluding_edges(const RangeImage& image, const OccludingEdgeOptions& options,
                          std::size_t first_row, std::size_t num_rows, Points& points,
                          Normals& directions);

}  // namespace trivet::kernels
