#include "kernels/scans/find_planes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "kernels/common/median.hpp"
#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

// The largest plane shows how flat others are measured, to this factor: farther ones scatter more.
constexpr float kFlatter = 3;
// Half the narrowest window that holds a flat surface, in standard deviations of the noise.
constexpr float kWindowDeviations = 4;
// A window half as wide holds this share of a surface that is flatter; of several surfaces it holds
// one, and of a scattered one ever less.
constexpr double kOneSurface = 0.9;

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
  return {normal, normal.dot(mean.cast<float>()), static_cast<float>(sum), tolerance};
}

/// A point near a plane.
struct NearPoint {
  float distance;  // signed
  float area;
};

/// The window of points along a plane's normal that holds most of their area.
struct Window {
  float middle = 0;
  double area = 0;
};

Window densest(std::vector<NearPoint>& near, float half_width) {
  std::ranges::sort(near, {}, &NearPoint::distance);
  Window best;
  double area = 0;
  std::size_t first = 0;
  for (const NearPoint& last : near) {
    area += static_cast<double>(last.area);
    while (last.distance - near[first].distance > 2 * half_width)
      area -= static_cast<double>(near[first++].area);
    if (area > best.area) best = {0.5F * (last.distance + near[first].distance), area};
  }
  return best;
}

/// Fit a plane to the flattest of the surfaces within the tolerance, in ever narrower windows, and
/// measure how far it scatters: 5 standard deviations by the median distance.
Plane flatten(const Plane& plane, const LeftPoints& left, const PlaneOptions& options,
              float tolerance, float min_cosine) {
  constexpr float kDeviations = 5 * 1.4826F;  // of a normal distribution, by the median
  constexpr float kRounding = 0.01F;          // share of the tolerance: of scans without noise
  std::vector<NearPoint> near;
  const auto collect = [&](const Plane& around, float within) {
    near.clear();
    for (std::size_t i = 0; i < left.points.size(); ++i) {
      if (left.assigned[i] == 0 &&
          lies_on(around, left.points[i], left.normals[i], within, min_cosine))
        near.push_back({around.normal.dot(left.points[i]) - around.offset, left.areas[i]});
    }
  };
  const float narrowest = std::max(kWindowDeviations * options.noise, kRounding * tolerance);
  Plane narrower = plane, flat = plane;
  float window = tolerance, flat_window = tolerance;
  double area = static_cast<double>(plane.area);
  while (window > narrowest) {
    collect(narrower, window);
    window = std::max(0.5F * window, narrowest);
    const Window best = densest(near, window);
    narrower.offset += best.middle;
    narrower = refit(narrower, left, window, min_cosine);
    if (best.area > kOneSurface * area) {
      flat = narrower;
      flat_window = window;
    }
    area = best.area;
  }
  collect(flat, 2 * flat_window);
  std::vector<float> distances;
  distances.reserve(near.size());
  for (const NearPoint& point : near) distances.push_back(std::abs(point.distance));
  flat.thickness =
      std::clamp(kDeviations * median(std::span(distances)), kRounding * tolerance, tolerance);
  flat.area = plane.area;
  return flat;
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
  float tolerance = options.tolerance;
  std::vector<std::size_t> on_best;
  const LeftPoints left{points, normals, areas, assigned};
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
        if (assigned[k] == 0 && lies_on(plane, points[k], normals[k], tolerance, min_cosine)) {
          plane.area += areas[k];
        }
      }
      if (plane.area > best.area) best = plane;
    }
    if (!(best.area > 0.3F * options.min_area))
      break;  // a single point's normal captures only part of its plane
    for (int round = 0; round < 3; ++round) {
      best = refit(best, left, tolerance, min_cosine);
    }
    if (!(best.area >= options.min_area)) break;
    on_best.clear();
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (assigned[k] == 0 && lies_on(best, points[k], normals[k], tolerance, min_cosine))
        on_best.push_back(k);
    }
    best = flatten(best, left, options, tolerance, min_cosine);
    planes.push_back(best);
    tolerance = std::min(tolerance, kFlatter * planes.front().thickness);
    for (const std::size_t k : on_best) assigned[k] = 1;
  }
  return planes;
}

void label_planes(PointsView points, NormalsView normals, std::span<const Plane> planes,
                  float max_angle_rad, std::span<std::uint8_t> labels) {
  TRIVET_REQUIRE(labels.size() == points.size(), "one label per point");
  const float min_cosine = std::cos(max_angle_rad);
  for (std::size_t i = 0; i < points.size(); ++i) {
    labels[i] = first_plane(planes, [&](const Plane& plane) {
      return lies_on(plane, points[i], normals[i], plane.thickness, min_cosine);
    });
  }
}

void label_planes(PointsView points, std::span<const Plane> planes,
                  std::span<std::uint8_t> labels) {
  TRIVET_REQUIRE(labels.size() == points.size(), "one label per point");
  for (std::size_t i = 0; i < points.size(); ++i) {
    labels[i] = first_plane(
        planes, [&](const Plane& plane) { return lies_near(plane, points[i], plane.thickness); });
  }
}

}  // namespace trivet::kernels
