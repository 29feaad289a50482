#include "engine/camera/check_depth_kind.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "kernels/scans/plane_samples.hpp"

namespace trivet::engine {
namespace {

using kernels::PlaneSamples;

constexpr float kLeastShare = 1 / 7.F;  // minimum share of the scene
constexpr float kLarger = 1.5F;
constexpr double kFlatter = 3;

/// The same depths in the other reading. A point p moves along its ray to s(p) p, where s, the
/// cosine to the axis or its inverse, is constant along the ray. A normal n therefore becomes
/// n - grad s (p . n) / s.
PlaneSamples read_otherwise(const PlaneSamples& samples, DepthKind said) {
  PlaneSamples other;
  other.areas = samples.areas;
  other.total_area = samples.total_area;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const Eigen::Vector3f p = samples.points[i], n = samples.normals[i];
    const float distance = p.norm(), cosine = p.z() / distance;
    const Eigen::Vector3f grad_cosine =
        (Eigen::Vector3f::UnitZ() - cosine / distance * p) / distance;
    const float s = said == DepthKind::z ? cosine : 1 / cosine;
    const Eigen::Vector3f grad =
        said == DepthKind::z ? grad_cosine : Eigen::Vector3f(-grad_cosine / (cosine * cosine));
    other.points.push_back(s * p);
    other.normals.push_back((n - grad * (p.dot(n) / s)).normalized());
  }
  return other;
}

/// Root mean square of the distances of the chosen points to their plane.
double flatness(PointsView points, std::span<const std::uint8_t> chosen) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double n = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (chosen[i] == 0) continue;
    sum += points[i].cast<double>();
    n += 1;
  }
  const Eigen::Vector3d mean = sum / std::max(n, 1.0);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (chosen[i] == 0) continue;
    const Eigen::Vector3d d = points[i].cast<double>() - mean;
    scatter += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]) / std::max(n, 1.0));
}

/// The largest plane of a reading, and the samples on it.
struct LargestPlane {
  float area = 0;
  std::vector<std::uint8_t> on_it;
};

LargestPlane find_largest(const PlaneSamples& samples, float tolerance) {
  kernels::PlaneOptions options;
  options.tolerance = options.noise = tolerance;  // curved planes stay whole
  options.min_area = kLeastShare * samples.total_area;
  options.max_planes = 1;
  LargestPlane largest;
  largest.on_it.resize(samples.points.size());
  const std::vector<kernels::Plane> planes =
      kernels::find_planes(samples.points, samples.normals, samples.areas, options);
  if (planes.empty()) return largest;
  largest.area = planes.front().area;
  kernels::label_planes(samples.points, samples.normals, planes, options.max_angle_rad,
                        largest.on_it);
  return largest;
}

}  // namespace

DepthReading check_depth_kind(const PreparedScene& scene, const Camera& camera) {
  DepthReading reading;
  const PlaneSamples said = kernels::sample_for_planes(scene.images.front());
  if (said.points.size() < 100) return reading;
  const PlaneSamples other = read_otherwise(said, camera.depth);
  const float tolerance = std::max(4 * scene.sensor.noise, scene.spacing);
  const LargestPlane as_said = find_largest(said, tolerance),
                     otherwise = find_largest(other, tolerance);
  if (as_said.area > kLarger * otherwise.area) {
    const double flat = flatness(said.points, as_said.on_it);
    if (flatness(other.points, as_said.on_it) > kFlatter * flat) reading.num_as_said = 1;
  } else if (otherwise.area > kLarger * as_said.area) {
    const double flat = flatness(other.points, otherwise.on_it),
                 curved = flatness(said.points, otherwise.on_it);
    if (!(curved > kFlatter * flat)) return reading;
    reading.num_otherwise = 1;
    reading.flat = static_cast<float>(flat);
    reading.curved = static_cast<float>(curved);
  }
  return reading;
}

}  // namespace trivet::engine
