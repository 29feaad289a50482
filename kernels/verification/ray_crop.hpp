/// Rays through an image at a posed model.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "kernels/common/ray_scene.hpp"
#include "kernels/scans/range_image.hpp"
#include "kernels/verification/verify_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// A model at a possible pose. All members are references.
struct PosedModel {
  const RayScene& surface;  ///< surface of the model, in its own frame and unit
  const ModelSamples& samples;
  const Pose& T_scene_model;
};

/// A rectangle of an image plane [pixel]; it may reach beyond the image.
struct PixelBox {
  float u0, v0, u1, v1;

  /// The bounding rectangle of both.
  PixelBox joined(const PixelBox& other) const noexcept;
};

/// A grid of rays: one per `stride` pixels in both directions, from (u0, v0) on.
struct RayCrop {
  static constexpr int kMaxSide = 48;  ///< rays along a side, without the margin

  int u0 = 0, v0 = 0, stride = 1, width = 0, height = 0;

  /// Rays through a box and `margin` more on each side.
  RayCrop(const PixelBox& box, int margin) noexcept;

  std::size_t size() const noexcept {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t at(int i, int j) const noexcept {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(i);
  }
  int u(int i) const noexcept { return u0 + stride * i; }
  int v(int j) const noexcept { return v0 + stride * j; }
};

/// Cosine of incidence below which a surface is too oblique for a depth measurement along the ray:
/// that of 80 degrees, as for the models' views (kMinViewCosine).
inline constexpr float kMinRayCosine = 0.17F;

/// Diameter of a ball around the model: twice the largest distance of samples from their center,
/// which no other point of the surface exceeds by more than their spacing.
float ball_diameter(const ModelSamples& samples) noexcept;

/// The projection of a ball in the camera's frame; empty if it is off the image, or the camera is
/// in the ball or next to it.
std::optional<PixelBox> project_ball(const ImageGeometry& geometry, const Eigen::Vector3f& center,
                                     float radius) noexcept;

/// Direction of a pixel's ray in the camera's frame; its z is 1.
Eigen::Vector3f ray_through(const ImageGeometry& geometry, int u, int v) noexcept;

/// Intersections of rays with a model.
struct RayHits {
  Column<float> depths;  ///< along the optical axis; infinite without a hit
  Normals normals;       ///< in the model's frame; not written without a hit
};

/// Intersect the rays of a crop with a model.
///
/// directions  working memory
void shoot_rays(const ImageGeometry& geometry, const RayCrop& crop, const RayScene& surface,
                const Pose& T_camera_model, Points& directions, RayHits& hits);

/// Intersection of a pixel's ray with the surface of a posed model.
struct ExpectedPoint {
  int u, v;     ///< pixel coordinates
  float z;      ///< depth of the surface
  float scale;  ///< length of the ray with z = 1, times the cosine of incidence
};

/// The measurement along a ray.
struct Measurement {
  float residual;      ///< perpendicular distance behind the model's surface; infinite for no
                       ///< measurement
  std::int64_t pixel;  ///< pixel index; -1: no measurement
};

/// The measurement of a pixel. If it is off by more than `tolerance`, the best-fitting one of the
/// pixel and its four neighbors: half a pixel of error must not look like a hole.
Measurement measure_along(const RangeImage& image, const ExpectedPoint& expected,
                          float tolerance) noexcept;

/// Whether a pixel at a distance of two to `reach` pixels agrees with the model's depth here:
/// sensors that match windows shift outlines. Tests eight directions.
bool measured_beside(const RangeImage& image, const ExpectedPoint& expected, float tolerance,
                     int reach) noexcept;

}  // namespace trivet::kernels
