/// Cameras recovered from unorganized scans whose points lie on the rays of an image's pixels.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "kernels/scans/fit_camera.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Recover the pixels of an image whose points were stored as a list: by a filter that removed those
/// without a measurement, or by a file format without rows. Each pixel is then one point again, as
/// dense and as exact as the sensor measured it.
///
/// The tangents x/z and y/z of such points, seen from the sensor along its optical axis, are
/// multiples of two pitches. The axis is sought among the six axes of the points' frame, so that the
/// frames of OpenCV, OpenGL and ROS are found.
///
/// viewpoint  position of the sensor
/// Empty unless all points are in front of the sensor, lie within some hundredths of a pixel of the
/// rays, and most have neighbors in the image: otherwise the points are not those of an image, or
/// few of them. The image has at most 16 pixels a point.
/// Cost: that of sorting 8,000 of the points; where these lie on rays, O(points), too.
std::optional<PosedCamera> fit_ray_lattice(PointsView points, const Eigen::Vector3f& viewpoint);

}  // namespace trivet::kernels
