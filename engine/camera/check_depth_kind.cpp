#include "engine/camera/check_depth_kind.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace trivet::engine {
namespace {

constexpr double kSamples = 6000;       // pixels that planes are searched in
constexpr float kLeastShare = 1 / 7.F;  // of the scene
constexpr float kLarger = 1.5F;
constexpr double kFlatter = 3;

/// Pixels spread over an image, as oriented points in the camera's frame.
struct Samples {
  Points points;
  Normals normals;
  std::vector<float> areas;  // that each stands for
  float total_area = 0;
};

Samples sample_image(const kernels::RangeImage& image) {
  const kernels::ImageGeometry& geometry = image.geometry;
  const auto measured = static_cast<double>(
      std::ranges::count_if(image.depth, [](float depth) { return depth > 0; }));
  const auto stride =
      static_cast<std::size_t>(std::max(1.0, std::floor(std::sqrt(measured / kSamples))));
  Samples samples;
  for (std::size_t v = stride / 2; v < geometry.height; v += stride) {
    for (std::size_t u = stride / 2; u < geometry.width; u += stride) {
      const std::size_t pixel = v * geometry.width + u;
      const Eigen::Vector3f n = image.normals[pixel];
      if (!(image.depth[pixel] > 0) || !std::isfinite(n.x())) continue;
      const Eigen::Vector3f p = geometry.back_project(pixel, image.depth[pixel]);
      const float facing = std::max(0.2F, -n.dot(p.normalized()));
      samples.points.push_back(p);
      samples.normals.push_back(n);
      samples.areas.push_back(p.z() * p.z() / (geometry.fx * geometry.fy) / facing);
      samples.total_area += samples.areas.back();
    }
  }
  return samples;
}

/// The same depths in the other reading. A point p moves along its ray to s(p) p, where s, the cosine
/// to the axis or its inverse, is the same all along the ray; so a normal n goes over into
/// n - grad s (p . n) / s.
Samples read_otherwise(const Samples& samples, DepthKind said) {
  Samples other;
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

/// Root mean square of the distances of some points to their plane.
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

LargestPlane find_largest(const Samples& samples, float tolerance) {
  kernels::PlaneOptions options;
  options.tolerance = tolerance;
  options.min_area = kLeastShare * samples.total_area;
  options.max_planes = 1;
  LargestPlane largest;
  largest.on_it.resize(samples.points.size());
  const std::vector<kernels::Plane> planes =
      kernels::find_planes(samples.points, samples.normals, samples.areas, options);
  if (planes.empty()) return largest;
  largest.area = planes.front().area;
  kernels::label_planes(samples.points, samples.normals, planes, tolerance, options.max_angle_rad,
                        largest.on_it);
  return largest;
}

}  // namespace

DepthReading check_depth_kind(const PreparedScene& scene, const Camera& camera) {
  DepthReading reading;
  const Samples said = sample_image(scene.images.front());
  if (said.points.size() < 100) return reading;
  const Samples other = read_otherwise(said, camera.depth);
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
