#include "kernels/verification/ray_crop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "storage/common/clamped_integer.hpp"

namespace trivet::kernels {
namespace {

constexpr std::array<std::array<int, 2>, 5> kCross{{{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

}  // namespace

PixelBox PixelBox::joined(const PixelBox& other) const noexcept {
  return {std::min(u0, other.u0), std::min(v0, other.v0), std::max(u1, other.u1),
          std::max(v1, other.v1)};
}

RayCrop::RayCrop(const PixelBox& box, int margin) noexcept {
  const float wide = box.u1 - box.u0, high = box.v1 - box.v0;
  // The camera is just outside the ball: its cone may have any width.
  constexpr int kMostPixels = 1 << 24;
  stride = clamped_integer(std::ceil(std::max(wide, high) / kMaxSide), 1, kMostPixels);
  const auto rays = [&](float length) {
    return clamped_integer(std::ceil(length / static_cast<float>(stride)), 0, kMaxSide) +
           2 * margin;
  };
  const auto middle = [](float from, float to) {
    return clamped_integer(std::floor(0.5F * (from + to)), -kMostPixels, kMostPixels);
  };
  width = rays(wide);
  height = rays(high);
  u0 = middle(box.u0, box.u1) - stride * (width / 2);
  v0 = middle(box.v0, box.v1) - stride * (height / 2);
}

float ball_diameter(const ModelSamples& samples) noexcept {
  float reach = 0;
  for (std::size_t i = 0; i < samples.points.size(); ++i)
    reach = std::max(reach, (samples.points[i] - samples.center).squaredNorm());
  return 2 * (std::sqrt(reach) + samples.spacing);
}

std::optional<PixelBox> project_ball(const ImageGeometry& g, const Eigen::Vector3f& center,
                                     float radius) noexcept {
  if (!(center.z() > 1.05F * radius)) return std::nullopt;
  const float x = center.x() / center.z(), y = center.y() / center.z();
  // The tangents of the ball's cone, bounded from above.
  const float reach = radius / std::sqrt(center.z() * center.z() - radius * radius);
  const float half_u = g.fx * reach * (1 + x * x + std::abs(x) * reach);
  const float half_v = g.fy * reach * (1 + y * y + std::abs(y) * reach);
  const float u = g.fx * x + g.cx, v = g.fy * y + g.cy;
  if (!(u + half_u > 0 && v + half_v > 0 && u - half_u < static_cast<float>(g.width) &&
        v - half_v < static_cast<float>(g.height))) {
    return std::nullopt;
  }
  return PixelBox{u - half_u, v - half_v, u + half_u, v + half_v};
}

Eigen::Vector3f ray_through(const ImageGeometry& g, int u, int v) noexcept {
  return {(static_cast<float>(u) - g.cx) / g.fx, (static_cast<float>(v) - g.cy) / g.fy, 1};
}

void shoot_rays(const ImageGeometry& g, const RayCrop& crop, const RayScene& surface,
                const Pose& T_camera_model, Points& directions, RayHits& hits) {
  directions.resize(crop.size());
  hits.depths.resize(crop.size());
  hits.normals.resize(crop.size());
  const Pose T_model_camera = T_camera_model.inverse();
  const Eigen::Matrix3f R = T_model_camera.linear();
  for (int j = 0; j < crop.height; ++j) {
    for (int i = 0; i < crop.width; ++i)
      directions.set(crop.at(i, j), R * ray_through(g, crop.u(i), crop.v(j)));
  }
  surface.intersect_many(T_model_camera.translation(), directions, hits.depths, hits.normals);
}

Measurement measure_along(const RangeImage& image, const ExpectedPoint& expected,
                          float tolerance) noexcept {
  const ImageGeometry& g = image.geometry;
  Measurement best{std::numeric_limits<float>::infinity(), -1};
  for (const auto& [du, dv] : kCross) {
    const int x = expected.u + du, y = expected.v + dv;
    if (x < 0 || y < 0 || x >= static_cast<int>(g.width) || y >= static_cast<int>(g.height))
      continue;
    const std::int64_t pixel = static_cast<std::int64_t>(y) * g.width + x;
    const float d = image.depth[static_cast<std::size_t>(pixel)];
    if (!(d > 0)) continue;
    const float r = (d - expected.z) * expected.scale;
    if (std::abs(r) < std::abs(best.residual)) best = {r, pixel};
    if (du == 0 && dv == 0 && std::abs(r) <= tolerance) break;
  }
  return best;
}

bool measured_beside(const RangeImage& image, const ExpectedPoint& expected, float tolerance,
                     int reach) noexcept {
  constexpr std::array<std::array<int, 2>, 8> kDirections{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
  const ImageGeometry& g = image.geometry;
  for (int step = 2; step <= reach; ++step) {
    for (const auto& [du, dv] : kDirections) {
      const int x = expected.u + step * du, y = expected.v + step * dv;
      if (x < 0 || y < 0 || x >= static_cast<int>(g.width) || y >= static_cast<int>(g.height))
        continue;
      const float d =
          image.depth[static_cast<std::size_t>(y) * g.width + static_cast<std::size_t>(x)];
      if (d > 0 && std::abs(d - expected.z) * expected.scale <= tolerance) return true;
    }
  }
  return false;
}

}  // namespace trivet::kernels
