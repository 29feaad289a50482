/// The rays that are shot through an image at a posed model.
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

/// A model where it may lie. All are referred to.
struct PosedModel {
  const RayScene& surface;  ///< of the model, in its own frame and unit
  const ModelSamples& samples;
  const Pose& T_scene_model;
};

/// A rectangle of an image plane [pixel]; it may reach beyond the image.
struct PixelBox {
  float u0, v0, u1, v1;

  /// The smallest one around both.
  PixelBox joined(const PixelBox& other) const noexcept;
};

/// Rays: one in each `stride` pixels, from (u0, v0) on.
struct RayCrop {
  static constexpr int kMaxSide = 48;  ///< rays along a side, without the margin

  int u0 = 0, v0 = 0, stride = 1, width = 0, height = 0;

  /// The rays through a box and `margin` more at each side.
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

/// Cosine of incidence below which a surface is too oblique for its depth along a ray to be measured:
/// that of 80 degrees, as models' views have it (kMinViewCosine).
inline constexpr float kMinRayCosine = 0.17F;

/// Twice the distance that samples lie from their center, which no other point of the surface
/// exceeds by more than their spacing: the diameter of a ball around the model.
float ball_diameter(const ModelSamples& samples) noexcept;

/// The box that a ball of the camera's frame projects into; nothing where that is off the image or
/// the camera is in the ball or next to it.
std::optional<PixelBox> project_ball(const ImageGeometry& geometry, const Eigen::Vector3f& center,
                                     float radius) noexcept;

/// The direction of a pixel's ray in the camera's frame; its z is 1.
Eigen::Vector3f ray_through(const ImageGeometry& geometry, int u, int v) noexcept;

/// Where rays meet a model.
struct RayHits {
  Column<float> depths;  ///< along the optical axis; infinite where nothing is met
  Normals normals;       ///< in the model's frame; not written where nothing is met
};

/// Find where the rays of a crop meet a model.
///
/// directions  working memory
void shoot_rays(const ImageGeometry& geometry, const RayCrop& crop, const RayScene& surface,
                const Pose& T_camera_model, Points& directions, RayHits& hits);

/// Where a pixel's ray meets the surface of a posed model.
struct ExpectedPoint {
  int u, v;     ///< of the pixel
  float z;      ///< depth of the surface
  float scale;  ///< length of the ray with z = 1, times the cosine of incidence
};

/// What was measured along a ray.
struct Measurement {
  float residual;      ///< perpendicular distance behind the model's surface; infinite for nothing
  std::int64_t pixel;  ///< -1: nothing was measured
};

/// The measurement of a pixel, or where that is off by more than `tolerance`, of the pixel or of
/// one of its four neighbors, whichever fits best: half a pixel of error must not look like a
/// hole.
Measurement measure_along(const RangeImage& image, const ExpectedPoint& expected,
                          float tolerance) noexcept;

/// Whether a pixel two or more away, and at most `reach`, shows what the model has here: outlines
/// of sensors that match windows lie beside their places. Looks along eight directions.
bool measured_beside(const RangeImage& image, const ExpectedPoint& expected, float tolerance,
                     int reach) noexcept;

}  // namespace trivet::kernels
