/// Scattered points as an image: one point for each pixel.
#pragma once

#include "kernels/scans/range_image.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// The merged points of a scattered scan and their pixels.
struct MergedPixels {
  PixelGrid grid;   ///< index of each pixel's merged point
  Points points;    ///< scene frame, in the order of their pixels
  Normals normals;  ///< normalized means; empty if none were given
};

/// Merge the points that share a pixel and lie on its nearest surface into their mean. The nearest
/// of several noisy points would lie in front of the surface; their mean lies on it, repeated
/// points change nothing, and a plane stays a plane.
///
/// Points of a pixel belong to its nearest surface if they lie less than a gate behind the nearest
/// one. The gate admits the slope of a surface seen at 75 degrees and the noise, which the smaller
/// differences within pixels show. With normals, points that face away from the camera are left
/// out. Cost: O(points + pixels).
MergedPixels merge_pixels(const ImageGeometry& geometry, PointsView points,
                          NormalsView normals = {});

}  // namespace trivet::kernels
