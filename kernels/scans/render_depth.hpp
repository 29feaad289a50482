/// Rendering of noise-free depth images.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/common/ray_scene.hpp"
#include "storage/data/cloud.hpp"

namespace trivet::kernels {

/// Whole rows of a depth image, row-major.
struct RenderedRows {
  /// z of the first surface along the optical axis, not along the ray [unit of the scene]; 0 for
  /// none.
  std::span<float> depth;
  /// One per depth: index of the instance that was hit; Hit::kNone without a hit or if the scene is
  /// a single surface.
  std::span<std::uint32_t> instances;
  /// Empty, or one per depth: unit face normal, towards the camera; NaN for none.
  NormalsSpan normals{};
};

/// Render rows of a depth image.
///
/// scene      surfaces in the camera's frame, usually RayScene::from_instances with T_camera_model
/// camera     pinhole; the ray of pixel (u, v) is ((u - cx) / fx, (v - cy) / fy, 1)
/// width      pixels in a row, > 0
/// first_row  row of the image that the output starts with
/// There is no near clipping plane, and both sides of a triangle are visible.
/// Rows are independent: any split into chunks of rows gives the same bits. No allocation.
void render_depth(const RayScene& scene, const Camera& camera, std::uint32_t width,
                  std::uint32_t first_row, const RenderedRows& out);

}  // namespace trivet::kernels
