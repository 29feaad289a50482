#include "kernels/spin_images/salient_points.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

constexpr double kDistinct = 0.975;  // largest ratio to the next larger eigenvalue
constexpr std::uint32_t kFewestOfScatter = 5, kFewestOfPatch = 6;
constexpr double kHarris = 0.04;

}  // namespace

void rate_by_iss(const VoxelHash& grid, PointsView points, float radius,
                 std::span<float> saliency) {
  TRIVET_REQUIRE(saliency.size() == points.size(), "one saliency a point");
  std::vector<float> weights(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    weights[i] = 1 / static_cast<float>(std::max(1U, grid.count_within(points[i], radius)));
  for (std::size_t i = 0; i < points.size(); ++i) {
    saliency[i] = 0;
    const Eigen::Vector3d p = points[i].cast<double>();
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    double sum = 0;
    std::uint32_t count = 0;
    grid.visit_within(points[i], radius, [&](std::uint32_t k, float) {
      if (k == i) return;
      const Eigen::Vector3d d = points[k].cast<double>() - p;
      const double w = static_cast<double>(weights[k]);
      scatter += w * d * d.transpose();
      sum += w;
      ++count;
    });
    if (count < kFewestOfScatter) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter / sum,
                                                                Eigen::EigenvaluesOnly);
    const Eigen::Vector3d spread = solver.eigenvalues();  // ascending
    if (spread[1] < kDistinct * spread[2] && spread[0] < kDistinct * spread[1])
      saliency[i] = static_cast<float>(std::max(0.0, spread[0]));
  }
}

void rate_by_harris(const VoxelHash& grid, PointsView points, NormalsView normals, float radius,
                    std::span<float> saliency) {
  TRIVET_REQUIRE(saliency.size() == points.size() && normals.size() == points.size(),
                 "one saliency and one normal a point");
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  for (std::size_t i = 0; i < points.size(); ++i) {
    saliency[i] = 0;
    const Eigen::Vector3d p = points[i].cast<double>(), n = normals[i].cast<double>();
    if (!n.allFinite()) continue;
    const Eigen::Vector3d e1 = n.unitOrthogonal(), e2 = n.cross(e1);
    Matrix6d A = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    std::uint32_t count = 0;
    grid.visit_within(points[i], radius, [&](std::uint32_t k, float) {
      const Eigen::Vector3d d =
          (points[k].cast<double>() - p) / static_cast<double>(radius);  // in radii
      const double x = d.dot(e1), y = d.dot(e2), z = d.dot(n);
      const Vector6d row{0.5 * x * x, x * y, 0.5 * y * y, x, y, 1};
      A += row * row.transpose();
      b += z * row;
      ++count;
    });
    if (count < kFewestOfPatch) continue;
    // z = p1/2 x^2 + p2 x y + p3/2 y^2 + p4 x + p5 y + p6
    A.diagonal().array() += 1e-9 * static_cast<double>(count);  // regularization for collinear
                                                                // points
    const Vector6d q = A.ldlt().solve(b);
    const double xx = q[3] * q[3] + 2 * q[0] * q[0] + 2 * q[1] * q[1];
    const double yy = q[4] * q[4] + 2 * q[1] * q[1] + 2 * q[2] * q[2];
    const double xy = q[3] * q[4] + 2 * q[0] * q[1] + 2 * q[1] * q[2];
    const double trace = xx + yy;
    saliency[i] = static_cast<float>(xx * yy - xy * xy - kHarris * trace * trace);
  }
}

void find_salient_points(const VoxelHash& grid, PointsView points, std::span<const float> saliency,
                         float radius, Column<std::uint32_t>& indices) {
  TRIVET_REQUIRE(saliency.size() == points.size(), "one saliency a point");
  indices.clear();
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!(saliency[i] > 0)) continue;
    bool highest = true;
    grid.visit_within(points[i], radius, [&](std::uint32_t k, float) {
      highest = highest && (saliency[k] < saliency[i] || (saliency[k] == saliency[i] && k >= i));
    });
    if (highest) indices.push_back(i);
  }
}

}  // namespace trivet::kernels
