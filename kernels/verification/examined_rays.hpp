/// The rays of one image at a posed model, with what each of them meets and measures.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "kernels/common/ray_scene.hpp"
#include "kernels/scans/range_image.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "kernels/verification/ray_crop.hpp"

namespace trivet::kernels {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Verdict of a ray. From kJudged on it hits the model inside the image. kEntered: hidden by the
/// plane that the model bears on. kUnmeasured: hit, but without a measurement. kSeenThrough:
/// something is measured far behind it.
enum RayState : std::uint8_t {
  kMissed,
  kOutside,
  kEntered,
  kHidden,
  kJudged,
  kUnmeasured,
  kSeenThrough,
  kConsistent
};

/// A ray, and the direction along the image in which the surface that it hit ends.
struct RayEnd {
  int i, j;    // index of the ray in the crop
  int di, dj;  // one of the four steps to a neighbor
};

/// Where a ray meets the model, in the camera's frame.
struct RayHit {
  Eigen::Vector3f place, normal;  // the normal points toward the camera
  float length = 0;               // of the ray with z = 1
  float facing = 0;               // cosine between the ray and the normal
};

/// Keeps references to all arguments. examine_pose writes the state and the residual of each ray.
struct ExaminedRays {
  static constexpr int kMargin = 4;  ///< rays beyond an outline, wider than any hole of a cloud
  static constexpr float kSameSurface = 1e-4F;  ///< of the diameter: rounding errors are smaller
  static constexpr float kInside = 0.25F;       ///< [pixel]
  static constexpr float kSlanted = 0.5F;       ///< cosine; steeper slopes look like steps
  static constexpr float kSamePlane = 1.5F;  ///< largest distance of a plane's points [tolerances]
  static constexpr int kAround = 3;  ///< rays around an outline that determine its direction

  ExaminedRays(const RangeImage& range_image, const PosedModel& model, const PixelBox& box,
               const ExamineOptions& examine_options, ExamineScratch& memory,
               const RayHits& ray_hits, const Column<float>& expected_depths,
               std::vector<JudgedRay>* judged)
      : image(range_image),
        geometry(image.geometry),
        options(examine_options),
        scratch(memory),
        hits(ray_hits),
        expected(expected_depths),
        judged_rays(judged),
        surface(model.surface),
        T_camera_model(geometry.T_camera_scene * model.T_scene_model),
        T_model_camera(T_camera_model.inverse()),
        R_scene_camera(geometry.T_camera_scene.linear().transpose()),
        diameter(model.samples.diameter),
        jump(std::max(2 * options.verify.tolerance, 0.03F * diameter)),
        step(2 * options.verify.tolerance),
        center(T_camera_model * model.samples.center),
        crop(box, kMargin) {}

  float depth_at(int i, int j) const noexcept { return hits.depths[crop.at(i, j)]; }

  bool inside(int u, int v) const noexcept {
    return u >= 0 && v >= 0 && u < static_cast<int>(geometry.width) &&
           v < static_cast<int>(geometry.height);
  }

  std::size_t pixel_at(int u, int v) const noexcept {
    return static_cast<std::size_t>(v) * geometry.width + static_cast<std::size_t>(u);
  }

  /// at  position in the camera's frame
  void record(RayVerdict verdict, const Eigen::Vector3f& at) const {
    if (judged_rays != nullptr)
      judged_rays->push_back({geometry.T_camera_scene.inverse() * at, verdict});
  }

  /// Call `body` with the step (di, dj) to each of the rays around one that miss the model.
  template <class Body>
  void each_missed_around(int i, int j, const Body& body) const {
    for (int dj = -kAround; dj <= kAround; ++dj) {
      for (int di = -kAround; di <= kAround; ++di) {
        if (di * di + dj * dj > kAround * kAround + 1) continue;
        if (scratch.state[crop.at(i + di, j + dj)] == kMissed) body(di, dj);
      }
    }
  }

  /// What a ray that hits the model meets.
  RayHit hit_at(int i, int j) const {
    RayHit hit;
    const Eigen::Vector3f ray = ray_through(geometry, crop.u(i), crop.v(j));
    hit.place = ray * depth_at(i, j);
    hit.normal = (T_camera_model.linear() * hits.normals[crop.at(i, j)]).normalized();
    if (hit.normal.dot(ray) > 0) hit.normal = -hit.normal;
    hit.length = ray.norm();
    hit.facing = -hit.normal.dot(ray) / hit.length;
    return hit;
  }

  /// The first place of the model along a ray from the camera, in the ray's lengths.
  Hit first_hit(const Eigen::Vector3f& ray) const noexcept {
    return surface.intersect(T_model_camera.translation(), T_model_camera.linear() * ray, 0,
                             std::numeric_limits<float>::infinity());
  }

  /// Whether the model's surface is open at an end: a ray before it meets the surface once, within
  /// the blur of outlines, as surfaces that were made from points have lips at their rims. What the
  /// model is a part of may go on beyond.
  bool is_open_at(const RayEnd& end) const {
    const float beyond = depth_at(end.i, end.j) + 2 * diameter;
    for (int k = 0; k <= options.edge_pixels; ++k) {
      const float inside = kInside + static_cast<float>(k);
      const Eigen::Vector3f ray =
          ray_through(geometry, crop.u(end.i), crop.v(end.j)) -
          inside * Eigen::Vector3f(static_cast<float>(end.di) / geometry.fx,
                                   static_cast<float>(end.dj) / geometry.fy, 0);
      const Hit first = first_hit(ray);
      const Eigen::Vector3f direction = T_model_camera.linear() * ray;
      const Hit last = surface.intersect(T_model_camera.translation() + beyond * direction,
                                         -direction, 0, beyond);
      if (first && !(beyond - last.distance > first.distance + kSameSurface * diameter))
        return true;
    }
    return false;
  }

  /// Whether the scene falls back behind the model at a pixel next to a hit: it is farther, or lies
  /// a step below the surface. Between two points of one curved surface there is no step: as much
  /// as the second lies below the plane of the first, so does the first below that of the second.
  /// A slanted surface that goes on is farther, too, but both points lie in the plane of the other.
  bool falls_back(const RayHit& hit, std::size_t pixel) const {
    const float d = image.depth[pixel];
    if (!(d > 0)) return true;
    const Eigen::Vector3f back = hit.place - geometry.back_project(pixel, d);
    const float below = hit.normal.dot(back), above = image.normals[pixel].dot(back);
    const float same = kSamePlane * options.verify.tolerance;
    const bool goes_on =  // NaN: no normal
        hit.facing >= kSlanted && std::abs(below) < same && std::abs(above) < same;
    if (d > hit.place.z() + jump && !goes_on) return true;
    return 0.5F * (below + above) > step;
  }

  /// J of a point and a direction in the camera's frame: see Examination::stability.
  Vector6 constraint(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const noexcept {
    const Eigen::Vector3f n = R_scene_camera * normal;
    const Eigen::Vector3f arm = R_scene_camera * (point - center) / (0.5F * diameter);
    Vector6 J;
    J << arm.cross(n).cast<double>(), n.cast<double>();
    return J;
  }

  /// J of a point of the outline for motion in a direction in the image.
  Vector6 edge_constraint(int i, int j, const Eigen::Vector2f& across) const noexcept {
    const float z = depth_at(i, j);
    const Eigen::Vector3f ray = ray_through(geometry, crop.u(i), crop.v(j));
    const Eigen::Vector2f a(across.x() * geometry.fx, across.y() * geometry.fy);
    const Eigen::Vector3f n(a.x(), a.y(), -a.dot(ray.head<2>()));
    return constraint(ray * z, n.normalized());
  }

  const RangeImage& image;
  const ImageGeometry& geometry;
  const ExamineOptions& options;
  ExamineScratch& scratch;
  const RayHits& hits;
  const Column<float>& expected;  ///< depth that the sensor measures of the model along each ray
  std::vector<JudgedRay>* judged_rays;
  const RayScene& surface;
  Pose T_camera_model, T_model_camera;
  Eigen::Matrix3f R_scene_camera;
  float diameter;
  float jump;  ///< smallest depth step between different objects
  float step;  ///< smallest step perpendicular to surfaces, where both are smooth
  Eigen::Vector3f center;
  RayCrop crop;
};

}  // namespace trivet::kernels
