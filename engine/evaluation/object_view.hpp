/// View of an object in a depth image: its silhouette, and the visible part of it.
///
/// Visibility is defined as in the BOP benchmark since 2019: a pixel of the silhouette is visible
/// if the object lies at most `delta` behind the measurement, or if nothing is measured. Source:
/// Hodan et al., BOP Challenge 2020, ECCVW 2020, section 2.2; bop_toolkit, scripts/calc_gt_info.py.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "kernels/common/ray_scene.hpp"
#include "kernels/verification/pose_errors.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"

namespace trivet::engine {

/// Measurements of a depth camera, as distances along its rays; 0: none.
struct MeasuredImage {
  Camera camera;
  kernels::PixelWindow window;  ///< the whole image
  std::vector<float> distance;

  kernels::DistanceMap map() const noexcept { return {window, distance}; }
};

/// Read a depth image; absent for a file of another kind. Errors: those of reading.
Result<std::optional<MeasuredImage>> read_measured_image(const std::filesystem::path& file,
                                                         const std::optional<Camera>& camera);

/// Convert raw depths, row by row.
MeasuredImage measured_image(std::span<const std::uint16_t> depths, std::uint32_t width,
                             const Camera& camera);

/// Rendering of a single object, as distances along the rays of a part of an image; 0: no object.
struct ObjectImage {
  kernels::PixelWindow window;
  std::vector<float> distance;

  kernels::DistanceMap map() const noexcept { return {window, distance}; }
};

/// Render an object. Errors: internal (ray tracing).
Result<ObjectImage> render_object(const kernels::RayScene& surface, const Pose& T_camera_object,
                                  const Camera& camera, const kernels::PixelWindow& window);

/// Number of pixels and their bounding rectangle.
struct PixelBox {
  int num_pixels = 0;
  int left = 0, top = 0, right = -1, bottom = -1;  ///< inclusive
  void add(int u, int v) noexcept {
    left = num_pixels == 0 ? u : std::min(left, u);
    right = num_pixels == 0 ? u : std::max(right, u);
    top = num_pixels == 0 ? v : std::min(top, v);
    bottom = num_pixels == 0 ? v : std::max(bottom, v);
    ++num_pixels;
  }
  /// x, y, width, height; zeros without pixels.
  std::array<int, 4> rectangle() const noexcept {
    return {left, top, right - left + 1, bottom - top + 1};
  }
};

struct ObjectView {
  PixelBox all;                    ///< silhouette, up to one image size beyond the borders
  PixelBox inside;                 ///< part of the silhouette within the image
  PixelBox visible;                ///< visible part of the silhouette
  int num_valid = 0;               ///< number of measured pixels of `inside`
  std::vector<std::uint8_t> mask;  ///< mask of `inside`, a byte per pixel of the image: 255 or 0
  std::vector<std::uint8_t> mask_visible{};  ///< mask of `visible`
};

/// An object's surface and bounding ball, in the unit of the image's distances.
struct ObjectShape {
  const kernels::RayScene& surface;
  Eigen::Vector3d center;
  double radius;
};

/// delta  > 0, in the unit of the image. Errors: internal (ray tracing).
Result<ObjectView> view_object(const ObjectShape& object, const Pose& T_camera_object,
                               const MeasuredImage& image, double delta);

}  // namespace trivet::engine
