#include "scan.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace trivet::bench {
namespace {

struct Hit {
  float depth = 1e9F;
  Eigen::Vector3f normal{0, 0, 0};

  void nearer(float t, const Eigen::Vector3f& n) {
    if (t > 0 && t < depth) *this = {t, n};
  }
};

// Three walls and a ball; the ray has z = 1, so its length up to a hit is the depth.
Hit cast(const Eigen::Vector3f& ray) {
  Hit hit;
  const auto wall = [&](const Eigen::Vector3f& normal, float distance) {
    const Eigen::Vector3f n = normal.normalized();
    hit.nearer(-distance / n.dot(ray), n);
  };
  wall({0, 0, -1}, 1.4F);
  wall({0.9F, 0.1F, -0.5F}, 0.6F);
  wall({0, -1, -0.3F}, 0.55F);
  const Eigen::Vector3f center(0.1F, 0.05F, 1.0F);
  const float radius = 0.18F, a = ray.squaredNorm(), b = ray.dot(center);
  const float discriminant = b * b - a * (center.squaredNorm() - radius * radius);
  if (discriminant > 0) {
    const float t = (b - std::sqrt(discriminant)) / a;
    hit.nearer(t, (t * ray - center) / radius);
  }
  return hit;
}

Scan make_scan(std::int64_t width) {
  Scan scan;
  scan.grid.width = static_cast<std::uint32_t>(width);
  scan.grid.height = static_cast<std::uint32_t>(width * 3 / 4);
  const float focal = 0.9F * static_cast<float>(width);
  scan.footprint_m = 1 / focal;
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, 0.001F);
  for (std::uint32_t v = 0; v < scan.grid.height; ++v) {
    for (std::uint32_t u = 0; u < scan.grid.width; ++u) {
      const Eigen::Vector3f ray(
          (static_cast<float>(u) - 0.5F * static_cast<float>(width)) / focal,
          (static_cast<float>(v) - 0.375F * static_cast<float>(width)) / focal, 1);
      const Hit hit = cast(ray);
      scan.grid.point_index.push_back(static_cast<std::int32_t>(scan.points.size()));
      scan.points.push_back((hit.depth + noise(random)) * ray);
      scan.truth.push_back(hit.normal);
    }
  }
  return scan;
}

}  // namespace

const Scan& scan_of_width(std::int64_t width) {
  static std::map<std::int64_t, Scan> scans;
  const auto [entry, is_new] = scans.try_emplace(width);
  if (is_new) entry->second = make_scan(width);
  return entry->second;
}

float search_radius(const Scan& scan) { return 4 * scan.footprint_m; }

double angle_rmse_deg(const Scan& scan, NormalsView normals) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Eigen::Vector3d found = normals[i].cast<double>(), truth = scan.truth[i].cast<double>();
    if (!found.allFinite()) continue;
    const double angle = std::atan2(found.cross(truth).norm(), std::abs(found.dot(truth)));
    sum += angle * angle;
    ++count;
  }
  return std::sqrt(sum / count) * 180 / std::numbers::pi;
}

}  // namespace trivet::bench
