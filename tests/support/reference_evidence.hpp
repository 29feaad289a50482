/// Slow reference implementation of the verification of a pose: in double precision, sample by
/// sample.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "kernels/scans/range_image.hpp"
#include "kernels/surfaces/visibility.hpp"
#include "support/analytic_scene.hpp"

namespace trivet::reference {

/// verify_pose as documented, for one image and in double precision. Samples whose result depends
/// on rounding are counted separately.
struct Evidence {
  std::array<int, 7>
      counts{};  // consistent, oblique, violation, occluded, unknown, outside, background
  double weight = 0;
  int undecided = 0;
};

inline Evidence evidence(const kernels::RangeImage& image, const test::SampledModel& model,
                         const Pose& T_scene_model, double tolerance) {
  const kernels::ImageGeometry& g = image.geometry;
  const auto in_double = [](const Pose& T) { return Eigen::Isometry3d(T.matrix().cast<double>()); };
  const Eigen::Isometry3d T = in_double(g.T_camera_scene) * in_double(T_scene_model);
  const Eigen::Vector3d eye = T.inverse().translation();
  std::size_t view = 0;
  for (std::size_t d = 1; d < kernels::kNumViews; ++d) {
    const auto cosine = [&](std::size_t k) {
      return kernels::view_direction(k).cast<double>().dot(eye);
    };
    if (cosine(d) > cosine(view)) view = d;
  }
  Evidence out;
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    if ((model.views[i][view / 64] >> (view % 64) & 1) == 0) continue;
    const Eigen::Vector3d p = T * model.points[i].cast<double>();
    const Eigen::Vector3d n = T.linear() * model.normals[i].cast<double>();
    const double facing = -n.dot(p.normalized());
    const double u = static_cast<double>(g.fx) * p.x() / p.z() + static_cast<double>(g.cx) + 0.5;
    const double v = static_cast<double>(g.fy) * p.y() / p.z() + static_cast<double>(g.cy) + 0.5;
    const auto close = [](double a, double b) { return std::abs(a - b) < 1e-4; };
    bool undecided = close(facing, 0.15) || close(u, std::round(u)) || close(v, std::round(v));
    if (facing <= 0.15) {
      out.undecided += undecided;
      continue;
    }
    const auto count = [&](std::size_t which) {
      undecided ? ++out.undecided : ++out.counts[which];
    };
    const int u0 = static_cast<int>(std::floor(u)), v0 = static_cast<int>(std::floor(v));
    const auto inside = [&](int x, int y) {
      return x >= 0 && y >= 0 && x < static_cast<int>(g.width) && y < static_cast<int>(g.height);
    };
    if (!inside(u0, v0)) {
      count(5);
      continue;
    }
    double best = 1e30;
    std::size_t best_pixel = 0;
    for (const auto& [du, dv] : {std::pair{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      if (!inside(u0 + du, v0 + dv)) continue;
      const auto at = static_cast<std::size_t>((v0 + dv) * static_cast<int>(g.width) + u0 + du);
      const double depth = static_cast<double>(image.depth[at]);
      const double r = (depth - p.z()) * facing;
      if (depth == 0 || std::abs(r) >= std::abs(best)) continue;
      best = r;
      best_pixel = at;
      if (du == 0 && dv == 0 && std::abs(r) < tolerance) break;
    }
    undecided = undecided || close(std::abs(best), tolerance);
    const bool background = image.plane[best_pixel] == 1;
    const double cosine = n.dot(image.normals[best_pixel].cast<double>());
    if (best == 1e30) {
      count(4);
    } else if (std::abs(best) > tolerance) {
      count(best > 0 || background ? 2 : 3);
    } else if (background) {
      count(6);
    } else {
      undecided = undecided || close(cosine, std::cos(0.8));
      count(cosine < std::cos(0.8) ? 1 : 0);
      const double share = best / tolerance;
      if (!undecided && cosine >= std::cos(0.8)) out.weight += (1 - share * share) * cosine;
    }
  }
  return out;
}

}  // namespace trivet::reference
