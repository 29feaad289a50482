#include "kernels/spin_images/local_frame.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kFewest = 5;
constexpr std::size_t kMoments = 10;  // weight; x y z; xx xy xz yy yz zz

/// Weighted sums over the points, in separate lanes: the order of addition is the same on all
/// processors.
template <std::size_t N>
struct Lanes {
  alignas(64) std::array<std::array<float, Support::kLanes>, N> sums{};

  std::array<double, N> totals() const noexcept {
    std::array<double, N> out{};
    for (std::size_t m = 0; m < N; ++m)
      for (const float sum : sums[m]) out[m] += static_cast<double>(sum);
    return out;
  }
};

TRIVET_SIMD_CLONES
Lanes<kMoments> sum_moments(const Support& support, float radius) noexcept {
  constexpr std::size_t L = Support::kLanes;
  const float *xs = support.x.data(), *ys = support.y.data(), *zs = support.z.data(),
              *areas = support.area.data();
  Lanes<kMoments> sums;
  for (std::size_t first = 0; first < support.size; first += L) {
    for (std::size_t k = 0; k < L; ++k) {
      const float x = xs[first + k], y = ys[first + k], z = zs[first + k];
      const float inside = std::max(0.0F, radius - std::sqrt(x * x + y * y + z * z));
      const float w = areas[first + k] * inside * inside;
      const float wx = w * x, wy = w * y, wz = w * z;
      sums.sums[0][k] += w;
      sums.sums[1][k] += wx;
      sums.sums[2][k] += wy;
      sums.sums[3][k] += wz;
      sums.sums[4][k] += wx * x;
      sums.sums[5][k] += wx * y;
      sums.sums[6][k] += wx * z;
      sums.sums[7][k] += wy * y;
      sums.sums[8][k] += wy * z;
      sums.sums[9][k] += wz * z;
    }
  }
  return sums;
}

TRIVET_SIMD_CLONES
Lanes<4> sum_heights(const Support& support, float radius, const Eigen::Vector3f& axis) noexcept {
  constexpr std::size_t L = Support::kLanes;
  const float *xs = support.x.data(), *ys = support.y.data(), *zs = support.z.data(),
              *areas = support.area.data();
  const float ax = axis.x(), ay = axis.y(), az = axis.z();
  Lanes<4> sums;
  for (std::size_t first = 0; first < support.size; first += L) {
    for (std::size_t k = 0; k < L; ++k) {
      const float x = xs[first + k], y = ys[first + k], z = zs[first + k];
      const float squared = x * x + (y * y + z * z), height = ax * x + (ay * y + az * z);
      const float inside = std::max(0.0F, radius - std::sqrt(squared)), weigh = inside * height;
      const float w = areas[first + k] * weigh * weigh;
      sums.sums[0][k] += w * x;
      sums.sums[1][k] += w * y;
      sums.sums[2][k] += w * z;
      sums.sums[3][k] += w * std::sqrt(std::max(0.0F, squared - height * height));
    }
  }
  return sums;
}

struct Moments {
  double weight = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

LocalFrame frame_of(const Moments& moments, float radius, const Eigen::Vector3f& normal) noexcept {
  LocalFrame frame;
  if (!(moments.weight > 0) || !(moments.second.trace() > 0)) return frame;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moments.second);
  const Eigen::Vector3d values = solver.eigenvalues().cwiseMax(0);  // ascending
  Eigen::Vector3d e1 = solver.eigenvectors().col(2), e3 = solver.eigenvectors().col(0);
  const double along = moments.first.dot(e1);
  if (along < 0) e1 = -e1;
  const Eigen::Vector3d n = normal.cast<double>();
  const double outward = n.allFinite() ? n.dot(e3) : moments.first.dot(e3);
  if (outward < 0) e3 = -e3;
  frame.axes.row(0) = e1.cast<float>();
  frame.axes.row(1) = e3.cross(e1).cast<float>();
  frame.axes.row(2) = e3.cast<float>();
  const double least = 1e-9 * values[2];
  frame.first_ratio = static_cast<float>(values[2] / std::max(values[1], least));
  frame.second_ratio = static_cast<float>(values[1] / std::max(values[0], least));
  const double aside = (moments.first - moments.first.dot(e3) * e3).norm();
  frame.lean = static_cast<float>(aside / (moments.weight * static_cast<double>(radius)));
  return frame;
}

}  // namespace

LocalFrame local_frame(const Support& support, float radius,
                       const Eigen::Vector3f& normal) noexcept {
  if (support.size < kFewest) return {};
  const std::array<double, kMoments> sums = sum_moments(support, radius).totals();
  Moments moments;
  moments.weight = sums[0];
  moments.first = {sums[1], sums[2], sums[3]};
  moments.second << sums[4], sums[5], sums[6], sums[5], sums[7], sums[8], sums[6], sums[8], sums[9];
  return frame_of(moments, radius, normal);
}

LocalFrame local_frame(const TriangleSupport& support, const Eigen::Vector3f& keypoint,
                       float radius, const Eigen::Vector3f& normal) noexcept {
  const PointsView& vertices = support.vertices;
  const Triangles& triangles = support.triangles;
  const Eigen::Vector3d p = keypoint.cast<double>();
  const auto max_edge = static_cast<double>(support.max_edge);
  const double r = radius, longest = max_edge * max_edge;
  Moments moments;
  for (const std::uint32_t t : support.around) {
    const std::array<Eigen::Vector3d, 3> d{vertices[triangles.a[t]].cast<double>() - p,
                                           vertices[triangles.b[t]].cast<double>() - p,
                                           vertices[triangles.c[t]].cast<double>() - p};
    const Eigen::Vector3d ab = d[1] - d[0], ac = d[2] - d[0], bc = d[2] - d[1];
    if (std::max({ab.squaredNorm(), ac.squaredNorm(), bc.squaredNorm()}) > longest) continue;
    const Eigen::Vector3d sum = d[0] + d[1] + d[2];
    const double inside = std::max(0.0, r - sum.norm() / 3);
    const double weight = 0.5 * ab.cross(ac).norm() * inside * inside;
    if (weight == 0) continue;
    // The mean of q q^T over a triangle: (sum of d d^T + sum d sum d^T) / 12.
    Eigen::Matrix3d scatter = sum * sum.transpose();
    for (const Eigen::Vector3d& corner : d) scatter += corner * corner.transpose();
    moments.weight += weight;
    moments.first += weight / 3 * sum;
    moments.second += weight / 12 * scatter;
  }
  return frame_of(moments, radius, normal);
}

void aim_first_axis(const Support& support, float radius, LocalFrame& frame) noexcept {
  frame.hold = 0;
  const Eigen::Vector3f e3 = frame.axes.row(2);
  const auto [x, y, z, all] = sum_heights(support, radius, e3).totals();
  const Eigen::Vector3d along = e3.cast<double>(), sum(x, y, z);
  const Eigen::Vector3d across = sum - sum.dot(along) / along.squaredNorm() * along;
  const double length = across.norm();
  if (!(length > 0) || !(all > 0)) return;
  const Eigen::Vector3d e1 = across / length;
  frame.axes.row(0) = e1.cast<float>();
  frame.axes.row(1) = along.cross(e1).cast<float>();
  frame.hold = static_cast<float>(std::min(1.0, length / all));
}

}  // namespace trivet::kernels
