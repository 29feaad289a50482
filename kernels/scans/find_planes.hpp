/// The dominant planes of a scan: tables, floors, walls of bins.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/data/points.hpp"

namespace trivet::kernels {

struct PlaneOptions {
  float tolerance = 0;          ///< distance still on the plane [scene unit], > 0
  float min_area = 0;           ///< smaller planes are not reported [scene unit^2], > 0
  float max_angle_rad = 0.35F;  ///< between a point's normal and the plane's
  std::size_t max_planes = 4;   ///< at most 255
  int num_trials = 300;
};

/// normal . p = offset; the normal looks to the sensor's side as the points' normals do.
struct Plane {
  Eigen::Matrix<float, 3, 1, Eigen::DontAlign> normal;
  float offset = 0;
  float area = 0;  ///< of the points on it [scene unit^2]
};

/// Find planes one after the other, largest first, among oriented points that stand for `areas` of
/// surface each.
///
/// A plane is proposed by one point and its normal, chosen by a fixed sequence (RANSAC, Fischler
/// and Bolles 1981, with one-point samples as the normals are known), and refitted three times to
/// the points then on it. Points without a normal are ignored. Same input, same planes.
std::vector<Plane> find_planes(PointsView points, NormalsView normals, std::span<const float> areas,
                               const PlaneOptions& options);

/// Number each point by the first plane it lies on, from 1; 0 for none.
void label_planes(PointsView points, NormalsView normals, std::span<const Plane> planes,
                  float tolerance, float max_angle_rad, std::span<std::uint8_t> labels);
/// The same by position alone.
void label_planes(PointsView points, std::span<const Plane> planes, float tolerance,
                  std::span<std::uint8_t> labels);

}  // namespace trivet::kernels
