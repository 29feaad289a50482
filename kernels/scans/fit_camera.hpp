/// Cameras recovered from organized scans, whose rows and columns are rays through one point.
#pragma once

#include <optional>

#include "kernels/scans/range_image.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Recover the camera of an organized scan whose file does not state it, by least squares on u = fx
/// x/z + cx. Empty unless 95 % of the points lie within half a pixel: otherwise the grid is not a
/// pinhole image. points are in the frame of a sensor at the origin that looks along +z.
std::optional<Camera> fit_camera(const PixelGrid& grid, PointsView points);

/// A camera with its place in the frame of the points.
struct PosedCamera {
  ImageGeometry geometry;
  Eigen::Vector3d center{0, 0, 0};  ///< position of the sensor
  double residual = 0;              ///< RMS distance of the points from their pixels [pixel]
};

/// Recover the camera and the sensor's place of an organized scan whose points are in any frame.
/// Noise along the rays does not affect it.
///
/// Empty unless 95 % of the points lie within half a pixel and the standard deviation of the place
/// is below 1 % of the distance to the points, as it is not for a flat scene. Sources: the direct
/// linear transform and its decomposition (Hartley and Zisserman, Multiple View Geometry, 2004,
/// sections 6.2 and 7.1), then Gauss-Newton on the distances in the image without skew.
std::optional<PosedCamera> fit_posed_camera(const PixelGrid& grid, PointsView points);

}  // namespace trivet::kernels
