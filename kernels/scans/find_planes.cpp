#include "kernels/scans/find_planes.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

bool lies_near(const Plane& plane, const Eigen::Vector3f& p, float tolerance) noexcept {
  return std::abs(plane.normal.dot(p) - plane.offset) <= tolerance;
}

bool lies_on(const Plane& plane, const Eigen::Vector3f& p, const Eigen::Vector3f& n,
             float tolerance, float min_cosine) noexcept {
  return lies_near(plane, p, tolerance) && plane.normal.dot(n) >= min_cosine;
}

/// The number of the first plane that satisfies `lies`, from 1; 0 for none.
template <class Lies>
std::uint8_t first_plane(std::span<const Plane> planes, Lies&& lies) noexcept {
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (lies(planes[k])) return static_cast<std::uint8_t>(k + 1);
  }
  return 0;
}

/// Points that are not assigned to a plane yet.
struct LeftPoints {
  PointsView points;
  NormalsView normals;
  std::span<const float> areas;
  std::span<const std::uint8_t> assigned;  // not 0: on a plane already found
};

/// Least-squares fit to the inliers, weighted by area.
Plane refit(const Plane& plane, const LeftPoints& left, float tolerance, float min_cosine) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double sum = 0;
  const auto each = [&](auto&& body) {
    for (std::size_t i = 0; i < left.points.size(); ++i) {
      if (left.assigned[i] == 0 &&
          lies_on(plane, left.points[i], left.normals[i], tolerance, min_cosine))
        body(i);
    }
  };
  each([&](std::size_t i) {
    mean += static_cast<double>(left.areas[i]) * left.points[i].cast<double>();
    sum += static_cast<double>(left.areas[i]);
  });
  if (!(sum > 0)) return plane;
  mean /= sum;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  each([&](std::size_t i) {
    const Eigen::Vector3d d = left.points[i].cast<double>() - mean;
    scatter += static_cast<double>(left.areas[i]) * d * d.transpose();
  });
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>();
  if (normal.dot(plane.normal) < 0) normal = -normal;
  return {normal, normal.dot(mean.cast<float>()), static_cast<float>(sum)};
}

}  // namespace

std::vector<Plane> find_planes(PointsView points, NormalsView normals, std::span<const float> areas,
                               const PlaneOptions& options) {
  TRIVET_REQUIRE(normals.size() == points.size() && areas.size() == points.size(),
                 "columns of one table");
  const float min_cosine = std::cos(options.max_angle_rad);
  std::vector<std::uint8_t> assigned(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) assigned[i] = !std::isfinite(normals.x[i]);

  std::vector<Plane> planes;
  std::uint64_t sequence = 0;
  while (!points.empty() && planes.size() < options.max_planes) {
    Plane best;
    for (int trial = 0; trial < options.num_trials; ++trial) {
      // The top bits of multiples of 2^64 / phi sample the points evenly.
      sequence += 0x9E3779B97F4A7C15ULL;
      const auto i = static_cast<std::size_t>(
          (static_cast<unsigned __int128>(sequence) * points.size()) >> 64);
      if (assigned[i] != 0) continue;
      Plane plane{normals[i], normals[i].dot(points[i]), 0};
      for (std::size_t k = 0; k < points.size(); ++k) {
        if (assigned[k] == 0 &&
            lies_on(plane, points[k], normals[k], options.tolerance, min_cosine)) {
          plane.area += areas[k];
        }
      }
      if (plane.area > best.area) best = plane;
    }
    if (!(best.area > 0.3F * options.min_area))
      break;  // a single point's normal captures only part of its plane
    for (int round = 0; round < 3; ++round) {
      best = refit(best, {points, normals, areas, assigned}, options.tolerance, min_cosine);
    }
    if (!(best.area >= options.min_area)) break;
    planes.push_back(best);
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (assigned[k] == 0 && lies_on(best, points[k], normals[k], options.tolerance, min_cosine))
        assigned[k] = 1;
    }
  }
  return planes;
}

void label_planes(PointsView points, NormalsView normals, std::span<const Plane> planes,
                  float tolerance, float max_angle_rad, std::span<std::uint8_t> labels) {
  TRIVET_REQUIRE(labels.size() == points.size(), "one label per point");
  const float min_cosine = std::cos(max_angle_rad);
  for (std::size_t i = 0; i < points.size(); ++i) {
    labels[i] = first_plane(planes, [&](const Plane& plane) {
      return lies_on(plane, points[i], normals[i], tolerance, min_cosine);
    });
  }
}

void label_planes(PointsView points, std::span<const Plane> planes, float tolerance,
                  std::span<std::uint8_t> labels) {
  TRIVET_REQUIRE(labels.size() == points.size(), "one label per point");
  for (std::size_t i = 0; i < points.size(); ++i) {
    labels[i] = first_plane(
        planes, [&](const Plane& plane) { return lies_near(plane, points[i], tolerance); });
  }
}

}  // namespace trivet::kernels
