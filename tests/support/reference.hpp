/// Slow reference implementations in double precision, written from the definitions, without code
/// of the kernels.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "storage/data/points.hpp"
#include "support/reference_matrices.hpp"

namespace trivet::reference {

inline double squared_distance(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return (a.cast<double>() - b.cast<double>()).squaredNorm();
}

/// Indices of the points within radius of a query, in ascending order.
inline std::vector<std::uint32_t> within(PointsView points, const Eigen::Vector3f& query,
                                         double radius) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (squared_distance(points[i], query) <= radius * radius) found.push_back(i);
  }
  return found;
}

/// Indices of the k nearest points, by distance, then index.
inline std::vector<std::uint32_t> nearest(PointsView points, const Eigen::Vector3f& query,
                                          std::size_t k) {
  std::vector<std::pair<double, std::uint32_t>> all;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    all.emplace_back(squared_distance(points[i], query), i);
  }
  std::ranges::sort(all);
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < std::min(k, all.size()); ++i) found.push_back(all[i].second);
  return found;
}

struct Plane {
  Eigen::Vector3d normal;  ///< unit, sign arbitrary
  double residual;         ///< root mean square distance
};

/// The plane of least squared distances; none for fewer than 3 points or points on a line.
inline std::optional<Plane> fit_plane(const std::vector<Eigen::Vector3d>& points) {
  if (points.size() < 3) return std::nullopt;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& p : points) {
    covariance += (p - mean) * (p - mean).transpose() / static_cast<double>(points.size());
  }
  const auto [spread, directions] = eigen_system(covariance);
  if (spread[1] <= 1e-6 * spread[2]) return std::nullopt;
  return Plane{directions.col(0), std::sqrt(std::max(0.0, spread[0]))};
}

/// Points by voxel, in the order of (z, y, x), each list in ascending order.
inline std::map<std::array<double, 3>, std::vector<std::uint32_t>> voxels(PointsView points,
                                                                          double cell) {
  std::map<std::array<double, 3>, std::vector<std::uint32_t>> out;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    out[{std::floor(points.z[i] / cell), std::floor(points.y[i] / cell),
         std::floor(points.x[i] / cell)}]
        .push_back(i);
  }
  return out;
}

}  // namespace trivet::reference
