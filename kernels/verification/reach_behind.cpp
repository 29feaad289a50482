#include "kernels/verification/reach_behind.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace trivet::kernels {
namespace {

constexpr float kParallel = 0.966F;  // 15 degrees: normals of samples at edges are between faces'

}  // namespace

PlaneReach reach_behind(const ModelSamples& samples, const Pose& T_scene_model, const Plane& plane,
                        float tolerance) noexcept {
  // The plane in the model's frame.
  const Eigen::Vector3f normal = T_scene_model.linear().transpose() * plane.normal;
  const float offset = plane.offset - plane.normal.dot(T_scene_model.translation());
  PlaneReach out;
  out.depth = -std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const Eigen::Vector3f point = samples.points[i];
    const float depth = offset - normal.dot(point);
    if (depth > out.depth) {
      out.depth = depth;
      out.deepest = point;
    }
    if (depth < -tolerance) continue;
    const float away = -normal.dot(samples.normals[i]);
    if (depth > tolerance) {
      out.entering += std::max(0.0F, away);
    } else if (away > kParallel) {
      out.bearing += away;
    }
  }
  return out;
}

std::size_t count_seen_behind(const RangeImage& image, const ModelSamples& samples,
                              std::size_t num_samples, const Pose& T_scene_model,
                              const Plane& plane, float distance) noexcept {
  const ImageGeometry& geometry = image.geometry;
  const Pose T_camera_model = geometry.T_camera_scene * T_scene_model;
  // The plane in the camera's frame.
  const Eigen::Vector3f normal = geometry.T_camera_scene.linear() * plane.normal;
  const float offset = plane.offset + normal.dot(geometry.T_camera_scene.translation());
  const std::size_t n = std::min(num_samples, samples.points.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3f point = samples.points[i];
    const std::int64_t at = geometry.pixel_of(T_camera_model * point);
    if (at < 0) continue;
    const auto pixel = static_cast<std::size_t>(at);
    const float depth = image.depth[pixel];
    if (depth > 0 && normal.dot(geometry.back_project(pixel, depth)) < offset - distance) ++count;
  }
  return count;
}

bool is_surrounded(const RangeImage& image, std::uint8_t plane,
                   const Eigen::Vector3f& place) noexcept {
  const std::int64_t at = image.geometry.pixel_of(place);
  if (at < 0) return false;
  const auto width = static_cast<std::int64_t>(image.geometry.width),
             height = static_cast<std::int64_t>(image.geometry.height);
  const auto shows = [&](std::int64_t du, std::int64_t dv) {
    for (std::int64_t u = at % width, v = at / width; u >= 0 && v >= 0 && u < width && v < height;
         u += du, v += dv) {
      if (image.near_plane[static_cast<std::size_t>(v * width + u)] == plane) return true;
    }
    return false;
  };
  constexpr std::array<std::array<int, 2>, 4> kLines{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  for (const auto& [du, dv] : kLines) {
    if (!shows(du, dv) || !shows(-du, -dv)) return false;
  }
  return true;
}

}  // namespace trivet::kernels
