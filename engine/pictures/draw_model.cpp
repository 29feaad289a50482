#include "engine/pictures/draw_model.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <vector>

#include "engine/common/parallel.hpp"
#include "engine/pictures/shade.hpp"

namespace trivet {
namespace {

using Eigen::Vector3f;

constexpr std::uint32_t kRays = 3;          // along each side of a pixel
constexpr float kDistance = 4;              // distance of the camera, in radii of the points
constexpr float kMargin = 1.04F;            // margin around the points
const Vector3f kFrom(0.55F, -0.75F, 0.5F);  // position of the camera; z is up
const Vector3f kGround(244, 245, 247), kSurface(122, 140, 163);

}  // namespace

Picture draw_model(const kernels::RayScene& surface, PointsView around, std::uint32_t width) {
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < around.size(); ++i) box.extend(around[i]);
  const Vector3f center = box.center();
  const Vector3f away = -kFrom.normalized(), right = away.cross(Vector3f::UnitZ()).normalized(),
                 down = away.cross(right);
  // As near as possible with all points in the picture.
  float radius = 0, extent = std::numeric_limits<float>::min();
  for (std::size_t i = 0; i < around.size(); ++i)
    radius = std::max(radius, (around[i] - center).norm());
  const Vector3f eye = center - kDistance * radius * away;
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Vector3f p = around[i] - eye;
    extent = std::max(
        {extent, std::abs(right.dot(p)) / away.dot(p), std::abs(down.dot(p)) / away.dot(p)});
  }

  Picture picture{width, width, {}};
  picture.rgb.resize(std::size_t{3} * width * width);
  const float step = 2 * kMargin * extent / static_cast<float>(width * kRays);
  engine::for_chunks(width, 8, [&](std::size_t first, std::size_t count) {
    const std::size_t rays = std::size_t{width} * kRays;
    Points directions(rays);
    std::vector<float> distances(rays);
    Normals normals(rays);
    std::vector<Vector3f> sums(width);
    for (std::size_t row = first; row < first + count; ++row) {
      std::ranges::fill(sums, Vector3f::Zero());
      for (std::size_t line = row * kRays; line < (row + 1) * kRays; ++line) {
        const auto offset = [&](std::size_t i) {
          return (static_cast<float>(i) + 0.5F - 0.5F * static_cast<float>(rays)) * step;
        };
        for (std::size_t i = 0; i < rays; ++i)
          directions.set(i, away + offset(i) * right + offset(line) * down);
        surface.intersect_many(eye, directions, distances, normals);
        for (std::size_t i = 0; i < rays; ++i) {
          if (!std::isfinite(distances[i])) {
            sums[i / kRays] += kGround;
            continue;
          }
          Vector3f normal(right.dot(normals[i]), down.dot(normals[i]), away.dot(normals[i]));
          if (normal.z() > 0) normal = -normal;
          sums[i / kRays] += kSurface * (0.35F + 1.1F * engine::shade(normal));
        }
      }
      for (std::size_t u = 0; u < width; ++u) {
        for (Eigen::Index k = 0; k < 3; ++k) {
          picture.rgb[3 * (row * width + u) + static_cast<std::size_t>(k)] =
              static_cast<std::uint8_t>(
                  std::clamp(sums[u][k] / (kRays * kRays) + 0.5F, 0.0F, 255.0F));
        }
      }
    }
  });
  return picture;
}

}  // namespace trivet
