#include "kernels/scans/merge_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

// Range of depths within a pixel of a surface at 75 degrees, in the pixel's width.
constexpr float kSlope = 4;
// Two measurements of a surface differ by less than 0.45 standard deviations in a quarter of all
// cases, and a measurement hardly ever lies 5 behind the nearest one.
constexpr float kNoiseGate = 12;

/// A point that the camera sees.
struct SeenPoint {
  std::int64_t pixel = -1;
  float depth = 0;
};

std::vector<SeenPoint> project(const ImageGeometry& geometry, PointsView points,
                               NormalsView normals) {
  std::vector<SeenPoint> seen(points.size());
  const Eigen::Matrix3f R = geometry.T_camera_scene.linear();
  StopCheck check_stop(StopCheck::kPoints);
  for (std::size_t i = 0; i < points.size(); ++i) {
    check_stop();
    const Eigen::Vector3f p = geometry.T_camera_scene * points[i];
    if (!normals.empty() && !(p.dot(R * normals[i]) < 0)) continue;
    seen[i] = {geometry.pixel_of(p), p.z()};
  }
  return seen;
}

/// The smallest depth of each pixel, and the quartile of the distances to the second smallest of
/// those that differ.
struct Nearest {
  Column<float> depth;
  float difference = 0;
};

Nearest find_nearest(std::span<const SeenPoint> seen, std::size_t num_pixels) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  Nearest nearest{Column<float>(num_pixels, kFar), 0};
  Column<float> second(num_pixels, kFar);
  StopCheck check_stop(StopCheck::kPoints);
  for (const auto& [pixel, depth] : seen) {
    check_stop();
    if (pixel < 0) continue;
    const auto at = static_cast<std::size_t>(pixel);
    if (depth < nearest.depth[at]) {
      second[at] = nearest.depth[at];
      nearest.depth[at] = depth;
    } else if (depth > nearest.depth[at] && depth < second[at]) {
      second[at] = depth;
    }
  }
  Column<float> differences;
  for (std::size_t k = 0; k < num_pixels; ++k) {
    if (second[k] < kFar) differences.push_back(second[k] - nearest.depth[k]);
  }
  if (differences.empty()) return nearest;
  const auto quartile = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 4);
  std::nth_element(differences.begin(), quartile, differences.end());
  nearest.difference = *quartile;
  return nearest;
}

/// Sums over the points of a pixel, relative to its first one.
struct Sum {
  Eigen::Vector3f first{0, 0, 0};
  Eigen::Vector3d offset{0, 0, 0}, normal{0, 0, 0};
  std::uint32_t count = 0;
};

}  // namespace

MergedPixels merge_pixels(const ImageGeometry& geometry, PointsView points, NormalsView normals) {
  const std::size_t num_pixels = std::size_t{geometry.width} * geometry.height;
  const std::vector<SeenPoint> seen = project(geometry, points, normals);
  const Nearest nearest = find_nearest(seen, num_pixels);
  MergedPixels merged;
  merged.grid.width = geometry.width;
  merged.grid.height = geometry.height;
  merged.grid.point_index.assign(num_pixels, PixelGrid::kNone);
  std::size_t num_seen = 0;
  for (std::size_t at = 0; at < num_pixels; ++at) {
    if (std::isfinite(nearest.depth[at]))
      merged.grid.point_index[at] = static_cast<std::int32_t>(num_seen++);
  }

  std::vector<Sum> sums(num_seen);
  StopCheck check_stop(StopCheck::kPoints);
  for (std::size_t i = 0; i < points.size(); ++i) {
    check_stop();
    if (seen[i].pixel < 0) continue;
    const auto at = static_cast<std::size_t>(seen[i].pixel);
    const float gate =
        std::max(kSlope * nearest.depth[at] / geometry.fx, kNoiseGate * nearest.difference);
    if (seen[i].depth > nearest.depth[at] + gate) continue;
    Sum& sum = sums[static_cast<std::size_t>(merged.grid.point_index[at])];
    if (sum.count++ == 0) sum.first = points[i];
    sum.offset += (points[i] - sum.first).cast<double>();
    if (!normals.empty()) sum.normal += normals[i].cast<double>();
  }
  for (const Sum& sum : sums) {
    check_stop();
    merged.points.push_back(sum.first + (sum.offset / sum.count).cast<float>());
    if (!normals.empty()) merged.normals.push_back(sum.normal.normalized().cast<float>());
  }
  return merged;
}

}  // namespace trivet::kernels
