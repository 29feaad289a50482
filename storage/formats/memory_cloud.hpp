/// Clouds of what is in memory already: arrays of points, meshes and depth images, as files of the
/// same content give them.
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

/// An array of two or three dimensions to read, wherever its numbers lie; valid while they do.
/// Strides count numbers, not bytes, from one to the next along a dimension, and may be negative or
/// zero: any array of NumPy comes in as it is. Numbers are aligned as their type asks for.
struct ArrayView {
  std::variant<const float*, const double*, const std::uint16_t*, const std::int32_t*,
               const std::uint32_t*, const std::int64_t*>
      data{};
  std::size_t num_dimensions = 2;
  std::array<std::size_t, 3> shape{};  ///< ones behind the last dimension
  std::array<std::ptrdiff_t, 3> strides{};

  /// Two dimensions, row after row.
  template <class T>
  static ArrayView packed(const T* data, std::size_t rows, std::size_t columns) noexcept {
    return {data, 2, {rows, columns, 1}, {static_cast<std::ptrdiff_t>(columns), 1, 1}};
  }
  /// Two dimensions, rows `row_stride` numbers and columns `column_stride` numbers apart.
  template <class T>
  static ArrayView strided(const T* data, std::size_t rows, std::size_t columns,
                           std::ptrdiff_t row_stride, std::ptrdiff_t column_stride = 1) noexcept {
    return {data, 2, {rows, columns, 1}, {row_stride, column_stride, 1}};
  }
  /// Three dimensions, an image of vectors.
  template <class T>
  static ArrayView packed(const T* data, std::size_t height, std::size_t width,
                          std::size_t length) noexcept {
    const auto step = static_cast<std::ptrdiff_t>(length);
    return {data, 3, {height, width, length}, {static_cast<std::ptrdiff_t>(width) * step, step, 1}};
  }
};

/// What belongs to the points, and what is allowed; the limits are those of ReadOptions.
struct MemoryCloudOptions {
  std::string_view name = "array";         ///< that stands for the data in messages
  std::optional<ArrayView> normals{};      ///< of the points' shape
  std::optional<ArrayView> triangles{};    ///< (m, 3) indices of points, counted as they come in
  std::uint64_t max_points = 100'000'000;  ///< more points are refused
  std::uint64_t max_pixels = 64'000'000;   ///< larger depth images are refused
  bool keep_origin = false;                ///< of models, as in ReadOptions
};

/// Take points as a cloud, as read_cloud takes them of a file.
///
/// xyz   (n, 3), or (height, width, 3) of an organized cloud: both above one make a pixel grid, seen
///       from the origin of its frame, in which pixels at (0, 0, 0) have no measurement
///
/// Points with a coordinate that is not finite are dropped and counted, with the triangles that use
/// one; normals that are not finite become zero. Values become floats; where points lie far from the
/// origin beside their extent, an offset is subtracted first, in double (Cloud::offset).
/// Errors: usage (a shape, a null pointer or an extent that cannot be), bad_data (too many points,
/// none that is finite, coordinates too large, triangles of points that are not there, no memory).
Result<Cloud> cloud_from_points(const ArrayView& xyz, const MemoryCloudOptions& options = {});

/// Put each measured pixel of a depth image at its place in front of the camera, as read_cloud does
/// with a PNG.
///
/// depths   (height, width), of any type; times camera.depth_scale a length along z; what is not
///          finite, zero or below is no measurement
///
/// Errors: usage (as above), bad_data (a camera that cannot be, too many pixels, negative depths
/// only, coordinates too large, no memory).
Result<Cloud> cloud_from_depths(const ArrayView& depths, const Camera& camera,
                                const MemoryCloudOptions& options = {});

}  // namespace trivet
