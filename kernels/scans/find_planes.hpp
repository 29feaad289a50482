/// The dominant planes of a scan: tables, floors, walls of bins.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/data/points.hpp"

namespace trivet::kernels {

struct PlaneOptions {
  float tolerance = 0;          ///< inlier distance from the plane [scene unit], > 0
  float noise = 0;              ///< standard deviation of a measurement [scene unit]
  float min_area = 0;           ///< smaller planes are not reported [scene unit^2], > 0
  float max_angle_rad = 0.35F;  ///< largest angle between the normals of an inlier and the plane
  std::size_t max_planes = 4;   ///< at most 255
  int num_trials = 300;
};

/// The plane normal . p = offset; the normal points to the sensor's side, as the points' normals
/// do.
struct Plane {
  Eigen::Matrix<float, 3, 1, Eigen::DontAlign> normal;
  float offset = 0;
  float area = 0;  ///< area of the inliers [scene unit^2]
  /// Largest distance of points that lie on the plane, by how flat its inliers are [scene unit].
  float thickness = 0;
};

/// Find planes one after the other, largest first, among oriented points that each represent an
/// area of the surface in `areas`.
///
/// A plane hypothesis comes from one point and its normal, chosen by a fixed sequence (RANSAC,
/// Fischler and Bolles 1981, with one-point samples as the normals are known), and is refitted
/// three times to its inliers. A sheet on a table is within the tolerance of the table, too: so the
/// plane is then fitted to the densest of ever narrower windows, while they hold a whole surface and
/// down to four standard deviations of the noise, and is as thick as five of its inliers' distances. Planes after the largest one are
/// searched to three times its thickness, or sheets on one another would be a plane. Points without a normal are ignored. Same input, same planes.
std::vector<Plane> find_planes(PointsView points, NormalsView normals, std::span<const float> areas,
                               const PlaneOptions& options);

/// Label each point with the number of the first plane it lies on, from 1; 0 for none.
void label_planes(PointsView points, NormalsView normals, std::span<const Plane> planes,
                  float max_angle_rad, std::span<std::uint8_t> labels);
/// As above, by position alone.
void label_planes(PointsView points, std::span<const Plane> planes, std::span<std::uint8_t> labels);

}  // namespace trivet::kernels
