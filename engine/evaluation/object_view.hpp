/// How a depth image sees an object in a pose: its silhouette, and what of it is visible.
///
/// Visibility as the BOP benchmark has it since 2019: a pixel of the silhouette is visible where the
/// object lies at most `delta` behind the measurement, or where nothing is measured. Source: Hodan et
/// al., BOP Challenge 2020, ECCVW 2020, section 2.2; bop_toolkit, scripts/calc_gt_info.py.
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

/// What a depth camera saw, as distances along its rays; 0: nothing.
struct MeasuredImage {
  Camera camera;
  kernels::PixelWindow window;  ///< the whole image
  std::vector<float> distance;

  kernels::DistanceMap map() const noexcept { return {window, distance}; }
};

/// None for a file that is no depth image. Errors: of reading.
Result<std::optional<MeasuredImage>> read_measured_image(const std::filesystem::path& file,
                                                         const std::optional<Camera>& camera);

/// The same of raw depths, row by row.
MeasuredImage measured_image(std::span<const std::uint16_t> depths, std::uint32_t width,
                             const Camera& camera);

/// An object alone, as distances along the rays of a part of an image; 0: it is not there.
struct ObjectImage {
  kernels::PixelWindow window;
  std::vector<float> distance;

  kernels::DistanceMap map() const noexcept { return {window, distance}; }
};

/// Errors: internal (ray tracing).
Result<ObjectImage> render_object(const kernels::RayScene& surface, const Pose& T_camera_object,
                                  const Camera& camera, const kernels::PixelWindow& window);

/// Pixels: how many, and the rectangle about them.
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
  /// x, y, width, height; zeros without any pixel.
  std::array<int, 4> rectangle() const noexcept {
    return {left, top, right - left + 1, bottom - top + 1};
  }
};

struct ObjectView {
  PixelBox all;                              ///< of the silhouette, up to an image's size beyond
  PixelBox inside;                           ///< of the same in the image
  PixelBox visible;                          ///< of its visible part
  int num_valid = 0;                         ///< pixels of `inside` that are measured
  std::vector<std::uint8_t> mask;            ///< of `inside`, a byte a pixel of the image: 255 or 0
  std::vector<std::uint8_t> mask_visible{};  ///< of `visible`
};

/// An object's surface and a ball about it, in the unit of the image's distances.
struct ObjectShape {
  const kernels::RayScene& surface;
  Eigen::Vector3d center;
  double radius;
};

/// delta  > 0, in the unit of the image. Errors: internal (ray tracing).
Result<ObjectView> view_object(const ObjectShape& object, const Pose& T_camera_object,
                               const MeasuredImage& image, double delta);

}  // namespace trivet::engine
