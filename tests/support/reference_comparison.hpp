/// Slow reference implementation of the comparison of two poses: in double precision, ray by ray,
/// with votes in a map.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "kernels/common/ray_scene.hpp"
#include "kernels/scans/range_image.hpp"
#include "kernels/verification/ray_crop.hpp"
#include "storage/data/model.hpp"

namespace trivet::reference {

struct Comparison {
  double log_ratio = 0, num_votes = 0, z = 0;
  int num_measured = 0;
};

/// compare_poses as documented, for one image whose plane 1 is background, and a crop with one ray
/// in each pixel.
inline Comparison comparison(const kernels::RangeImage& image, const kernels::RayScene& surface,
                             double diameter, const Pose& first, const Pose& second, double noise,
                             double correlation, double tolerance, const kernels::RayCrop& crop) {
  const kernels::ImageGeometry& g = image.geometry;
  const int width = static_cast<int>(g.width), height = static_cast<int>(g.height);
  const double sigma = std::hypot(noise, 0.004 * diameter);

  struct Sight {
    double z, scale;  // scale 0: grazing
    int fifth;        // of the cosine between ray and normal
  };
  const auto sight_along = [&](const Pose& pose,
                               const Eigen::Vector3f& ray) -> std::optional<Sight> {
    const Pose inverse = pose.inverse();
    const kernels::Hit hit = surface.intersect(inverse.translation(), inverse.linear() * ray, 0,
                                               std::numeric_limits<float>::infinity());
    if (!hit) return std::nullopt;
    const Eigen::Vector3d d = ray.cast<double>();
    const double scale = std::abs((pose.linear() * hit.normal).cast<double>().dot(d));
    return Sight{static_cast<double>(hit.distance), scale > 0.17 * d.norm() ? scale : 0,
                 std::min(4, static_cast<int>(5 * scale / d.norm()))};
  };
  struct Measured {
    double residual;  // infinite without a hit
    bool background;
  };
  const auto measured = [&](const Sight& sight, int u, int v) {
    double best = std::numeric_limits<double>::infinity();
    bool background = false;
    const int cross[5][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    for (const auto& [du, dv] : cross) {
      if (u + du < 0 || v + dv < 0 || u + du >= width || v + dv >= height) continue;
      const auto pixel = static_cast<std::size_t>((v + dv) * width + u + du);
      const double depth = static_cast<double>(image.depth[pixel]);
      if (!(depth > 0)) continue;
      const double r = (depth - sight.z) * sight.scale;
      if (std::abs(r) < std::abs(best)) {
        best = r;
        background = image.plane[pixel] == 1;
      }
      if (du == 0 && dv == 0 && std::abs(r) <= tolerance) break;
    }
    return Measured{best, background};
  };
  struct Share {
    double num = 0, num_missing = 0;
    void add(bool missing) {
      num += 1;
      num_missing += missing ? 1 : 0;
    }
    double missing() const { return std::max(0.02, num_missing / num); }
  };
  Share on, off;
  std::array<Share, 5> alike;
  const auto likelihood = [&](const std::optional<Sight>& sight, int u, int v) {
    if (!sight) return 1.0;
    const auto [r, background] = measured(*sight, u, v);
    if (!std::isfinite(r)) {
      if (std::min(on.num, off.num) < 50) return 1.0;
      const Share& likewise = alike[static_cast<std::size_t>(sight->fifth)];
      return (likewise.num < 50 ? on : likewise).missing() / off.missing();
    }
    if (background) return std::abs(r) <= tolerance ? 1.0 : 0.03;
    const auto normal = [&](double wide) {
      return std::exp(-r * r / (2 * wide * wide * sigma * sigma)) / wide;
    };
    const double mixture =
        0.03 + 9.97 * ((1 - 0.3 * correlation) * normal(1) + 0.3 * correlation * normal(8));
    return r < 0 ? std::max(1.0, mixture) : mixture;
  };
  const auto for_each_ray = [&](auto&& visit) {
    for (int v = std::max(0, crop.v0); v < std::min(height, crop.v0 + crop.height); ++v) {
      for (int u = std::max(0, crop.u0); u < std::min(width, crop.u0 + crop.width); ++u) {
        const Eigen::Vector3f ray((static_cast<float>(u) - g.cx) / g.fx,
                                  (static_cast<float>(v) - g.cy) / g.fy, 1);
        visit(sight_along(first, ray), sight_along(second, ray), u, v);
      }
    }
  };

  const auto is_missing = [&](int u, int v) {
    return !std::isfinite(measured({1, 1, 0}, u, v).residual);
  };
  for_each_ray([&](const auto& a, const auto& b, int u, int v) {
    if (a.has_value() != b.has_value() || (a && (a->scale == 0 || b->scale == 0))) return;
    (a ? on : off).add(is_missing(u, v));
    if (!a) return;
    for (const int fifth : {a->fifth, b->fifth})
      alike[static_cast<std::size_t>(fifth)].add(is_missing(u, v));
  });

  Comparison out;
  std::map<std::pair<int, int>, double> votes;
  for_each_ray([&](const auto& a, const auto& b, int u, int v) {
    if (!a && !b) return;
    if ((a && a->scale == 0) || (b && b->scale == 0)) return;
    if (a && b &&
        (is_missing(u, v) || std::abs(a->z - b->z) * std::max(a->scale, b->scale) <= tolerance / 2))
      return;
    out.num_votes += 1.0 / 9;
    const double r = measured(!b || (a && a->z < b->z) ? *a : *b, u, v).residual;
    out.num_measured += std::isfinite(r) && r >= -tolerance ? 1 : 0;
    votes[{(u - crop.u0) / 3, (v - crop.v0) / 3}] +=
        std::log(likelihood(a, u, v) / likelihood(b, u, v)) / 9;
  });
  double squares = 0;
  for (const auto& [at, vote] : votes) {
    out.log_ratio += vote;
    squares += vote * vote;
  }
  if (squares > 0) out.z = out.log_ratio / std::sqrt(squares);
  return out;
}

}  // namespace trivet::reference
