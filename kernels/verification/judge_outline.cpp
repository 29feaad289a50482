#include "kernels/verification/judge_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "storage/common/clamped_integer.hpp"

namespace trivet::kernels {
namespace {

constexpr float kFoldCosine = 0.866F;  // 30 degrees: noise turns normals by less
constexpr int kRounded = 3;            // largest width of a crease rounded by sensors, in windows
constexpr float kSameCosine = 0.985F;  // 10 degrees: directions of outlines err by less
// Buried parts extend deeper beneath the measured surface than distorted depth and the rims of
// clouds: by more than this many tolerances, within these limits of the number of rays.
constexpr float kDeep = 3;
constexpr int kLeastRays = 3, kMostRays = 16;
constexpr int kMostReach = 4096;  // pixels; unbounded for a surface next to the camera

/// Whether the model ends here: the rays beyond hit nothing. Clouds have holes a few rays wide.
bool ends_at(const ExaminedRays& rays, const RayEnd& end) noexcept {
  for (int k = 1; k <= ExaminedRays::kMargin; ++k) {
    if (rays.scratch.state[rays.crop.at(end.i + k * end.di, end.j + k * end.dj)] != kMissed)
      return false;
  }
  return true;
}

/// Whether the visible part ends here, and the model continues deep beneath the measured surface.
bool dips_at(const ExaminedRays& rays, const RayEnd& end) noexcept {
  if (rays.scratch.state[rays.crop.at(end.i, end.j)] != kConsistent) return false;
  const float deep = -kDeep * rays.options.verify.tolerance;
  const int least = kLeastRays + rays.options.edge_pixels / rays.crop.stride;
  for (int k = 1; k <= kMostRays; ++k) {
    const int x = end.i + k * end.di, y = end.j + k * end.dj;
    if (x < 0 || y < 0 || x >= rays.crop.width || y >= rays.crop.height) return false;
    const std::size_t at = rays.crop.at(x, y);
    if (rays.scratch.state[at] != kHidden) return false;
    if (k >= least && rays.scratch.residual[at] < deep) return true;
  }
  return false;
}

/// Width in pixels over which sensors blur an outline. The outline is somewhere between the last
/// ray that hits the model and the next one.
int reach(const ExaminedRays& rays, float z) noexcept {
  return rays.crop.stride - 1 +
         std::max({3, rays.options.edge_pixels + 1,
                   clamped_integer(0.03F * rays.diameter * rays.geometry.fx / z, 0, kMostReach)});
}

/// Whether the scene's surface bends between both sides of a pixel, (du, dv) away from it; false
/// if either side has no normal.
bool folds(const ExaminedRays& rays, int u, int v, int du, int dv) noexcept {
  const int u0 = u - du, v0 = v - dv, u1 = u + du, v1 = v + dv;
  if (!rays.inside(u0, v0) || !rays.inside(u1, v1)) return false;
  const auto normal = [&](int x, int y) { return rays.image.normals[rays.pixel_at(x, y)]; };
  return normal(u0, v0).dot(normal(u1, v1)) < kFoldCosine;
}

/// Whether the scene's surface bends towards the sensor as at the contact of two bodies: sharply,
/// or over the pixels over which sensors that match windows round off a crease. The far side of a
/// body's own edge bends away.
bool creases(const ExaminedRays& rays, int u, int v, int du, int dv) noexcept {
  const int away = static_cast<int>(rays.options.window) + 1;
  for (int k = away; k <= kRounded * away; k += away) {
    if (!folds(rays, u, v, k * du, k * dv)) continue;
    const std::size_t from = rays.pixel_at(u - k * du, v - k * dv);
    const std::size_t to = rays.pixel_at(u + k * du, v + k * dv);
    const Eigen::Vector3f across = rays.geometry.back_project(to, rays.image.depth[to]) -
                                   rays.geometry.back_project(from, rays.image.depth[from]);
    if (rays.image.normals[from].dot(across) > 0 && rays.image.normals[to].dot(across) < 0)
      return true;
  }
  return false;
}

/// Whether the scene continues in the plane before this ray: no edge, no fold.
///
/// limit  largest distance from the plane [scene unit]
bool runs_on(const ExaminedRays& rays, const RayEnd& end, float limit) noexcept {
  const auto [i, j, di, dj] = end;
  const int u = rays.crop.u(i), v = rays.crop.v(j);
  const int away = static_cast<int>(rays.options.window) + 1;  // no normal is fitted to both sides
  if (folds(rays, u, v, away * di, away * dj)) return false;
  const int u0 = u - away * di, v0 = v - away * dj;
  if (!rays.inside(u0, v0)) return false;
  const std::size_t before = rays.pixel_at(u0, v0);
  const Eigen::Vector3f n = rays.image.normals[before];
  if (!(rays.image.depth[before] > 0) || !std::isfinite(n.x())) return false;
  const float offset = n.dot(rays.geometry.back_project(before, rays.image.depth[before]));
  const int last = reach(rays, rays.depth_at(i, j));
  for (int step = 1; step <= last; ++step) {
    const int x = u + step * di, y = v + step * dj;
    if (!rays.inside(x, y)) return false;
    const float d = rays.image.depth[rays.pixel_at(x, y)];
    if (!(d > 0) ||
        std::abs(n.dot(rays.geometry.back_project(rays.pixel_at(x, y), d)) - offset) > limit)
      return false;
  }
  return true;
}

/// Count the scene beyond a position of the outline; returns whether that is free.
bool judge_beyond(const ExaminedRays& rays, const RayEnd& end, Examination& out) {
  const auto [i, j, di, dj] = end;
  const RayHit hit = rays.hit_at(i, j);
  const int last = reach(rays, hit.place.z());
  bool any = false, open = false, judged = true;
  for (int step = 1; step <= last; ++step) {
    const int u = rays.crop.u(i) + step * di, v = rays.crop.v(j) + step * dj;
    if (!rays.inside(u, v)) break;
    any = true;
    const std::size_t pixel = rays.pixel_at(u, v);
    if (rays.falls_back(hit, pixel)) {
      open = true;
    } else if (rays.image.depth[pixel] < hit.place.z() - rays.jump ||
               rays.options.verify.is_background(rays.image.near_plane[pixel])) {
      judged = false;  // hidden by something nearer, or standing on a table
    }
  }
  if (!any) return false;
  // Nothing is known of what the scene is beyond an open surface, unless it ends there, too.
  if (!open && judged && rays.is_open_at(end)) return false;
  const auto length = static_cast<float>(rays.crop.stride);
  out.outline += length;
  if (open) {
    out.outline_free += length;
  } else if (judged) {
    const bool touches = creases(rays, rays.crop.u(i), rays.crop.v(j), di, dj);
    (touches ? out.outline_touching : out.outline_crossed) += length;
    if (!touches) rays.record(RayVerdict::runs_on, hit.place);
  }
  return open;
}

/// Whether the sensor saw the model up to its end here, except for grazing rays and those over
/// which edges are blurred.
bool agrees_within(const ExaminedRays& rays, const RayEnd& end) noexcept {
  const int last = reach(rays, rays.depth_at(end.i, end.j)) / rays.crop.stride;
  for (int k = 0; k <= last; ++k) {
    const int x = end.i - k * end.di, y = end.j - k * end.dj;
    if (x < 0 || y < 0 || x >= rays.crop.width || y >= rays.crop.height) return false;
    if (rays.scratch.state[rays.crop.at(x, y)] == kConsistent) return true;
  }
  return false;
}

/// The direction in the image perpendicular to the outline, to 4 degrees; a unit vector. Zero if
/// the surrounding rays that miss the model lie elsewhere than those of them that hit something
/// farther. Near a corner of the model that is hidden or continues, its sides would constrain the
/// pose along themselves, as the steps of slanted sides would.
Eigen::Vector2f direction_across(const ExaminedRays& rays, const RayEnd& end) {
  const RayHit hit = rays.hit_at(end.i, end.j);
  Eigen::Vector2f missed(0, 0), measured(0, 0);
  rays.each_missed_around(end.i, end.j, [&](int di, int dj) {
    const Eigen::Vector2f step(static_cast<float>(di), static_cast<float>(dj));
    missed += step;
    const int u = rays.crop.u(end.i + di), v = rays.crop.v(end.j + dj);
    if (!rays.inside(u, v)) return;
    const std::size_t pixel = rays.pixel_at(u, v);
    if (rays.image.depth[pixel] > 0 && rays.falls_back(hit, pixel)) measured += step;
  });
  const bool agree = missed.dot(measured) > kSameCosine * missed.norm() * measured.norm();
  return agree ? missed.normalized() : Eigen::Vector2f::Zero();
}

/// Whether the surface that agrees with the model's visible part goes on in front of this hidden
/// end, in one plane: nothing lies on the model, it dips beneath what it is taken for.
bool is_overrun_at(const ExaminedRays& rays, const RayEnd& end) noexcept {
  for (int k = 1; k <= kMostRays; ++k) {
    const int x = end.i - k * end.di, y = end.j - k * end.dj;
    if (x < 0 || y < 0 || x >= rays.crop.width || y >= rays.crop.height) return false;
    const std::uint8_t state = rays.scratch.state[rays.crop.at(x, y)];
    if (state == kConsistent)
      return runs_on(rays, {x, y, end.di, end.dj},
                     ExaminedRays::kSamePlane * rays.options.verify.tolerance);
    if (state != kHidden && state != kJudged) return false;
  }
  return false;
}

/// Evaluate an end of the model: the scene beyond, and the constraint on the pose.
void judge_end(const ExaminedRays& rays, const RayEnd& end, Examination& out, OutlineSums& sums,
               EdgeEquations* edges) {
  const bool free = judge_beyond(rays, end, out);
  sums.count += 1;
  if (edges != nullptr) edges->add(rays, end);
  if (!free || !agrees_within(rays, end)) return;
  const Vector6 J = rays.edge_constraint(end.i, end.j, direction_across(rays, end));
  sums.covariance.noalias() += J * J.transpose();
}

}  // namespace

void judge_outline(const ExaminedRays& rays, Examination& out, OutlineSums& sums,
                   EdgeEquations* edges) {
  constexpr std::array<std::array<int, 2>, 4> kSteps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (int j = ExaminedRays::kMargin; j < rays.crop.height - ExaminedRays::kMargin; ++j) {
    for (int i = ExaminedRays::kMargin; i < rays.crop.width - ExaminedRays::kMargin; ++i) {
      const std::uint8_t state = rays.scratch.state[rays.crop.at(i, j)];
      if (state < kHidden) continue;
      for (const auto& [di, dj] : kSteps) {
        const RayEnd end{i, j, di, dj};
        if (state == kHidden) {  // what is hidden by something else is no part of the outline
          if (ends_at(rays, end) && is_overrun_at(rays, end))
            out.outline += static_cast<float>(rays.crop.stride);
        } else if (ends_at(rays, end)) {
          judge_end(rays, end, out, sums, edges);
        } else if (dips_at(rays, end) && runs_on(rays, end, rays.jump)) {
          out.buried += static_cast<float>(rays.crop.stride);
        }
      }
    }
  }
}

}  // namespace trivet::kernels
