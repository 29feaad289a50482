/// Clouds from data in memory: arrays of points, meshes and depth images, with the same results as
/// from files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"

namespace trivet {

/// Read-only view of an array of two or three dimensions; valid while the data is. Strides count
/// numbers, not bytes, along a dimension, and may be negative or zero, so any NumPy array fits
/// without a copy. Numbers have the alignment of their type.
struct ArrayView {
  std::variant<const float*, const double*, const std::uint16_t*, const std::int32_t*,
               const std::uint32_t*, const std::int64_t*>
      data{};
  std::size_t num_dimensions = 2;
  std::array<std::size_t, 3> shape{};  ///< sizes, 1 for dimensions that do not exist
  std::array<std::ptrdiff_t, 3> strides{};

  /// Two dimensions, contiguous rows.
  template <class T>
  static ArrayView packed(const T* data, std::size_t rows, std::size_t columns) noexcept {
    return {data, 2, {rows, columns, 1}, {static_cast<std::ptrdiff_t>(columns), 1, 1}};
  }
  /// Two dimensions with row and column strides, in numbers.
  template <class T>
  static ArrayView strided(const T* data, std::size_t rows, std::size_t columns,
                           std::ptrdiff_t row_stride, std::ptrdiff_t column_stride = 1) noexcept {
    return {data, 2, {rows, columns, 1}, {row_stride, column_stride, 1}};
  }
  /// Three dimensions: an image of vectors.
  template <class T>
  static ArrayView packed(const T* data, std::size_t height, std::size_t width,
                          std::size_t length) noexcept {
    const auto step = static_cast<std::ptrdiff_t>(length);
    return {data, 3, {height, width, length}, {static_cast<std::ptrdiff_t>(width) * step, step, 1}};
  }
};

/// Attributes of the points and size limits; the limits are those of ReadOptions.
struct MemoryCloudOptions {
  std::string_view name = "array";         ///< name of the data in messages
  std::optional<ArrayView> normals{};      ///< normals in the shape of the points
  std::optional<ArrayView> triangles{};    ///< (m, 3) indices of points in input order
  std::uint64_t max_points = 100'000'000;  ///< more points are refused
  std::uint64_t max_pixels = 64'000'000;   ///< larger depth images are refused
  bool keep_origin = false;                ///< for models, as in ReadOptions
};

/// Turn an array of points into a cloud, as read_cloud does for a file.
///
/// xyz   (n, 3), or (height, width, 3) for an organized cloud. If both sizes exceed one, the result
///       has a pixel grid seen from the origin, in which pixels at (0, 0, 0) have no measurement
///
/// Points with a non-finite coordinate are dropped and counted, with the triangles that use them;
/// non-finite normals become zero. Values become floats. If the points lie far from the origin
/// relative to their extent, an offset is subtracted first, in double (Cloud::offset).
/// Errors: usage (an invalid shape, null pointer or extent), bad_data (too many points, no finite
/// one, coordinates too large, triangle indices out of range, no memory).
Result<Cloud> cloud_from_points(const ArrayView& xyz, const MemoryCloudOptions& options = {});

/// Back-project each measured pixel of a depth image, as read_cloud does for a PNG.
///
/// depths   (height, width), of any type; a depth times camera.depth_scale is a length along z;
///          non-finite, zero and negative values are no measurement
///
/// Errors: usage (as above), bad_data (an impossible camera, too many pixels, only negative depths,
/// coordinates too large, no memory).
Result<Cloud> cloud_from_depths(const ArrayView& depths, const Camera& camera,
                                const MemoryCloudOptions& options = {});

}  // namespace trivet
