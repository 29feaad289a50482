/// Local frames and spin images by their formulas, in double precision.
#pragma once

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "kernels/spin_images/spin_image.hpp"
#include "kernels/spin_images/support.hpp"
#include "support/reference_matrices.hpp"

namespace trivet::reference {

struct WeightedPoint {
  Eigen::Vector3d position;  ///< relative to the keypoint
  double area;
};

inline std::vector<WeightedPoint> points_of(const kernels::Support& support) {
  std::vector<WeightedPoint> points;
  for (std::size_t i = 0; i < support.size; ++i) {
    points.push_back({Eigen::Vector3f(support.x[i], support.y[i], support.z[i]).cast<double>(),
                      static_cast<double>(support.area[i])});
  }
  return points;
}

/// Rows e1, e2, e3. Guo et al., GRAPP 2013.
inline Eigen::Matrix3d local_frame(const std::vector<WeightedPoint>& points, double radius,
                                   const Eigen::Vector3d& normal) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Vector3d lean = Eigen::Vector3d::Zero();
  for (const auto& [d, area] : points) {
    const double w = area * std::pow(std::max(0.0, radius - d.norm()), 2);
    scatter += w * d * d.transpose();
    lean += w * d;
  }
  const Eigen::Matrix3d directions = eigen_system(scatter).vectors;
  Eigen::Vector3d e1 = directions.col(2), e3 = directions.col(0);
  if (lean.dot(e1) < 0) e1 *= -1;
  if (normal.dot(e3) < 0) e3 *= -1;
  Eigen::Matrix3d axes;
  axes << e1.transpose(), e3.cross(e1).transpose(), e3.transpose();
  return axes;
}

/// e1 of a frame with this e3, from heights, and its reliability. Yang et al., Pattern Recognition
/// 2017.
inline std::pair<Eigen::Vector3d, double> first_axis(const std::vector<WeightedPoint>& points,
                                                     double radius, const Eigen::Vector3d& e3) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double all = 0;
  for (const auto& [d, area] : points) {
    const double height = d.dot(e3), inside = std::max(0.0, radius - d.norm());
    const Eigen::Vector3d across = d - height * e3;
    sum += area * inside * inside * height * height * across;
    all += area * inside * inside * height * height * across.norm();
  }
  return {sum.normalized(), sum.norm() / all};
}

/// Spin image with bilinear weights, after Johnson and Hebert, PAMI 1999.
inline std::array<double, kernels::kSpinImageSize> spin_image(
    const std::vector<WeightedPoint>& points, const Eigen::Vector3d& axis, double radius) {
  constexpr int n = kernels::kSpinBins;
  std::array<double, kernels::kSpinImageSize> image{};
  for (const auto& [d, area] : points) {
    const double beta = d.dot(axis);
    const double alpha = std::sqrt(std::max(0.0, d.squaredNorm() - beta * beta));
    const double u = (radius - beta) * (n - 1) / (2 * radius), v = alpha * (n - 1) / radius;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        image[static_cast<std::size_t>(i * n + j)] +=
            area * std::max(0.0, 1 - std::abs(u - i)) * std::max(0.0, 1 - std::abs(v - j));
      }
    }
  }
  return image;
}

}  // namespace trivet::reference
