#include "kernels/scans/range_image.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "storage/common/clamped_integer.hpp"
#include "storage/common/stop.hpp"
#include "storage/data/bounding_box.hpp"

namespace trivet::kernels {
namespace {

constexpr float kMaxTangent = 3.732F;     // tan 75 degrees
constexpr std::uint32_t kMaxSide = 2048;  // pixels

/// Number of pixels of this pitch (in tangent units) with at least one point.
std::size_t count_occupied(PointsView tangents, const Eigen::Vector2f& low, float pitch,
                           std::uint32_t width, std::uint32_t height, std::vector<bool>& occupied) {
  occupied.assign(std::size_t{width} * height, false);
  constexpr std::size_t kNone = 2 * std::size_t{kMaxSide};  // past the last row and column
  std::size_t num_occupied = 0;
  StopCheck check_stop(StopCheck::kPoints);
  for (std::size_t i = 0; i < tangents.size(); ++i) {
    check_stop();
    const auto u = clamped_integer((tangents.x[i] - low.x()) / pitch, std::size_t{0}, kNone);
    const auto v = clamped_integer((tangents.y[i] - low.y()) / pitch, std::size_t{0}, kNone);
    if (u >= width || v >= height || occupied[v * width + u]) continue;
    occupied[v * width + u] = true;
    ++num_occupied;
  }
  return num_occupied;
}

/// Number of distinct positions; points closer than a fraction of the finest pixel are one
/// position. Clouds that hold all points twice, or again after processing by another writer,
/// contain no more information.
std::size_t count_places(PointsView tangents, const Eigen::Vector2f& low, float finest) {
  constexpr float kParts = 16;
  constexpr auto kMost = std::uint64_t{1} << 31U;
  std::vector<std::uint64_t> places(tangents.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const float u = (tangents.x[i] - low.x()) / finest, v = (tangents.y[i] - low.y()) / finest;
    places[i] = clamped_integer(kParts * u, std::uint64_t{0}, kMost) << 32U |
                clamped_integer(kParts * v, std::uint64_t{0}, kMost);
  }
  std::sort(places.begin(), places.end());
  return static_cast<std::size_t>(std::unique(places.begin(), places.end()) - places.begin());
}

/// The pitch at which about half of the points share a pixel with another, by bisection.
float shared_pitch(PointsView tangents, const Eigen::Vector2f& low, const Eigen::Array2f& extent,
                   float finest) {
  std::vector<bool> occupied;
  const auto occupied_at = [&](float pitch) {
    const auto width = clamped_integer(extent.x() / pitch, 0U, kMaxSide) + 1;
    const auto height = clamped_integer(extent.y() / pitch, 0U, kMaxSide) + 1;
    return count_occupied(tangents, low, pitch, width, height, occupied);
  };

  // Few points coincide by chance.
  std::size_t num_points = tangents.size();
  if (4 * occupied_at(finest) < 3 * num_points) {
    const std::size_t num_places = count_places(tangents, low, finest);
    if (4 * num_places < 3 * num_points) num_points = num_places;
  }

  float fine = finest, coarse = extent.maxCoeff() / 4;
  for (int step = 0; step < 14 && coarse > 1.02F * fine; ++step) {
    const float pitch = std::sqrt(fine * coarse);
    (2 * occupied_at(pitch) > num_points ? fine : coarse) = pitch;
  }
  return std::max(coarse, finest);
}

}  // namespace

std::optional<ImageGeometry> choose_camera(PointsView points, const Eigen::Vector3f& viewpoint,
                                           float pixel_size) {
  if (points.size() < 3) return std::nullopt;
  const Eigen::AlignedBox3f box = bounding_box(points);
  const Eigen::Vector3f towards = (box.min() + box.max()) / 2 - viewpoint;
  if (!(towards.norm() > 1e-6F * box.diagonal().norm())) return std::nullopt;

  // Rows of the rotation: right, down, forward. Any roll will do; use the least aligned axis as an
  // auxiliary vector.
  const Eigen::Vector3f forward = towards.normalized();
  Eigen::Index least = 0;
  forward.cwiseAbs().minCoeff(&least);
  const Eigen::Vector3f right = Eigen::Vector3f::Unit(least).cross(forward).normalized();
  ImageGeometry geometry;
  geometry.T_camera_scene.linear().row(0) = right.transpose();
  geometry.T_camera_scene.linear().row(1) = forward.cross(right).transpose();
  geometry.T_camera_scene.linear().row(2) = forward.transpose();
  geometry.T_camera_scene.translation() = -(geometry.T_camera_scene.linear() * viewpoint);

  Points tangents;
  tangents.reserve(points.size());
  Eigen::Array2f t_low(kMaxTangent, kMaxTangent), t_high(-kMaxTangent, -kMaxTangent);
  StopCheck check_stop(StopCheck::kPoints);
  for (std::size_t i = 0; i < points.size(); ++i) {
    check_stop();
    const Eigen::Vector3f p = geometry.T_camera_scene * points[i];
    if (!(p.z() > 0)) continue;
    const Eigen::Array2f t(p.x() / p.z(), p.y() / p.z());
    if (!(t.abs().maxCoeff() < kMaxTangent)) continue;
    tangents.push_back({t.x(), t.y(), 0});
    t_low = t_low.min(t);
    t_high = t_high.max(t);
  }
  const Eigen::Array2f extent = t_high - t_low;
  if (tangents.size() < 3 || !(extent.maxCoeff() > 0)) return std::nullopt;

  const float finest = std::max(extent.maxCoeff() / static_cast<float>(kMaxSide - 4),
                                static_cast<float>(1 / kLargestFocalLength));
  const float pitch = pixel_size > 0 ? std::max(finest, pixel_size / towards.norm())
                                     : shared_pitch(tangents, t_low, extent, finest);
  geometry.width = clamped_integer(extent.x() / pitch, 0U, kMaxSide) + 3;
  geometry.height = clamped_integer(extent.y() / pitch, 0U, kMaxSide) + 3;
  geometry.fx = geometry.fy = 1.0F / pitch;
  geometry.cx = 1.0F - t_low.x() / pitch;
  geometry.cy = 1.0F - t_low.y() / pitch;
  return geometry;
}

std::size_t fill_small_holes(const ImageGeometry& geometry, float max_step, int min_neighbors,
                             Column<float>& depth) {
  const Column<float> measured = depth;
  std::size_t filled = 0;
  const std::size_t width = geometry.width;
  for (std::size_t v = 1; v + 1 < geometry.height; ++v) {
    check_stop();
    for (std::size_t u = 1; u + 1 < width; ++u) {
      const std::size_t pixel = v * width + u;
      if (measured[pixel] > 0) continue;
      float sum = 0, low = std::numeric_limits<float>::infinity(), high = 0;
      int count = 0;
      for (const std::size_t row : {pixel - width, pixel, pixel + width}) {
        for (const std::size_t at : {row - 1, row, row + 1}) {
          if (!(measured[at] > 0)) continue;
          sum += measured[at];
          low = std::min(low, measured[at]);
          high = std::max(high, measured[at]);
          ++count;
        }
      }
      if (count < min_neighbors || high - low > max_step) continue;
      depth[pixel] = sum / static_cast<float>(count);
      ++filled;
    }
  }
  return filled;
}

}  // namespace trivet::kernels
