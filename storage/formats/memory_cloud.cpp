#include "storage/formats/memory_cloud.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <span>
#include <utility>

#include "storage/files/numbers.hpp"
#include "storage/formats/arrange_points.hpp"
#include "storage/formats/depth_image.hpp"
#include "storage/formats/finish.hpp"

namespace trivet {
namespace {

using formats::Input;
using formats::Positions;

std::string shape_text(const ArrayView& array) {
  return array.num_dimensions == 3
             ? fmt::format("({}, {}, {})", array.shape[0], array.shape[1], array.shape[2])
             : fmt::format("({}, {})", array.shape[0], array.shape[1]);
}

bool is_empty(const ArrayView& array) {
  return array.shape[0] == 0 || array.shape[1] == 0 ||
         (array.num_dimensions == 3 && array.shape[2] == 0);
}

/// Refuse impossible arrays, so that offsets of numbers can be computed without overflow.
///
/// what   "points", "normals", ...
Result<void> check_array(const Input& input, std::string_view what, const ArrayView& array) {
  const auto refuse = [&](std::string_view text) {
    return Error{ErrorCode::usage, fmt::format("{}: {}: {}", input.file.string(), what, text)};
  };
  if (array.num_dimensions != 2 && array.num_dimensions != 3)
    return refuse(fmt::format("expected 2 or 3 dimensions, found {}", array.num_dimensions));
  if (is_empty(array)) return {};
  if (std::visit([](const auto* data) { return data == nullptr; }, array.data))
    return refuse("expected a pointer to numbers, found null");

  const std::uint64_t number_bytes =
      std::visit([](const auto* data) { return sizeof(*data); }, array.data);
  const auto place = std::visit(
      [](const auto* data) { return reinterpret_cast<std::uintptr_t>(data); }, array.data);
  if (place % number_bytes != 0) {
    return refuse(
        fmt::format("expected numbers at multiples of {} bytes, found them between", number_bytes));
  }
  std::uint64_t left = std::uint64_t{std::numeric_limits<std::ptrdiff_t>::max()} / number_bytes;
  for (std::size_t d = 0; d < array.num_dimensions; ++d) {
    const std::ptrdiff_t stride = array.strides[d];
    const std::uint64_t step =
        stride < 0 ? 0 - static_cast<std::uint64_t>(stride) : static_cast<std::uint64_t>(stride);
    const std::uint64_t steps = array.shape[d] - 1;
    // Division, as the product could overflow.
    if (step > 0 && steps > left / step) {
      return refuse(
          fmt::format("expected an array that fits into memory, found {} with steps of {}"
                      " in dimension {}",
                      shape_text(array), stride, d));
    }
    left -= steps * step;
  }
  return {};
}

/// Call `use` with a function (row, column, channel) -> number, whatever the type of the numbers.
template <class Use>
auto with_numbers(const ArrayView& array, Use&& use) {
  return std::visit(
      [&](const auto* data) {
        return use([data, steps = array.strides](std::size_t i, std::size_t j, std::size_t k) {
          return data[static_cast<std::ptrdiff_t>(i) * steps[0] +
                      static_cast<std::ptrdiff_t>(j) * steps[1] +
                      static_cast<std::ptrdiff_t>(k) * steps[2]];
        });
      },
      array.data);
}

/// The vectors of (n, 3) or (height, width, 3), row by row. Pre: checked.
Positions vectors_of(const ArrayView& array) {
  Positions vectors;
  if (is_empty(array)) return vectors;
  const std::size_t width = array.num_dimensions == 3 ? array.shape[1] : 1;
  vectors.resize(array.shape[0] * width);
  with_numbers(array, [&](auto number) {
    std::size_t at = 0;
    for (std::size_t v = 0; v < array.shape[0]; ++v) {
      for (std::size_t u = 0; u < width; ++u, ++at) {
        const auto component = [&](std::size_t k) {
          return static_cast<double>(array.num_dimensions == 3 ? number(v, u, k) : number(v, k, 0));
        };
        vectors.x[at] = component(0);
        vectors.y[at] = component(1);
        vectors.z[at] = component(2);
      }
    }
  });
  return vectors;
}

Result<void> check_points(const Input& input, const ArrayView& xyz,
                          const MemoryCloudOptions& options) {
  TRIVET_TRY(check_array(input, "points", xyz));
  const bool image = xyz.num_dimensions == 3;
  if (xyz.shape[image ? 2 : 1] != 3) {
    return Error{
        ErrorCode::usage,
        fmt::format("{}: points: expected the shape (n, 3) or (height, width, 3), found {}",
                    input.file.string(), shape_text(xyz))};
  }
  if (options.normals) {
    TRIVET_TRY(check_array(input, "normals", *options.normals));
    if (shape_text(*options.normals) != shape_text(xyz)) {
      return Error{ErrorCode::usage,
                   fmt::format("{}: normals: expected the shape of the points, {}, found {}",
                               input.file.string(), shape_text(xyz), shape_text(*options.normals))};
    }
  }
  // Division, as the product could overflow.
  const std::uint64_t rows = xyz.shape[0], columns = image ? xyz.shape[1] : 1;
  if (columns > 0 && rows > input.max_points() / columns) {
    return input.refuse(fmt::format("holds points of the shape {}, more than the limit of {}",
                                    shape_text(xyz), input.max_points()));
  }
  return {};
}

Result<Triangles> copy_triangles(const Input& input, const ArrayView& array,
                                 std::size_t num_points) {
  TRIVET_TRY(check_array(input, "triangles", array));
  if (array.num_dimensions != 2 || array.shape[1] != 3) {
    return Error{ErrorCode::usage, fmt::format("{}: triangles: expected the shape (m, 3), found {}",
                                               input.file.string(), shape_text(array))};
  }
  Triangles triangles;
  if (is_empty(array)) return triangles;
  return with_numbers(array, [&](auto number) -> Result<Triangles> {
    for (std::size_t t = 0; t < array.shape[0]; ++t) {
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto corner = static_cast<double>(number(t, k, 0));
        const auto index = to_index(corner, num_points);
        if (!index) {
          return input.refuse(fmt::format(
              "triangle {}: expected indices of the {} points, found {}", t, num_points, corner));
        }
        corners[k] = *index;
      }
      triangles.push_back(corners[0], corners[1], corners[2]);
    }
    return std::move(triangles);
  });
}

Result<Cloud> copy_points(const Input& input, const ArrayView& xyz,
                          const MemoryCloudOptions& options) {
  TRIVET_TRY(check_points(input, xyz, options));
  Positions positions = vectors_of(xyz);
  const std::size_t num_points = positions.size();
  Triangles triangles;
  if (options.triangles) {
    TRIVET_TRY_ASSIGN(Triangles copied, copy_triangles(input, *options.triangles, num_points));
    triangles = std::move(copied);
  }
  const std::size_t height = xyz.num_dimensions == 3 && num_points > 0 ? xyz.shape[0] : 1;
  Cloud cloud = arrange_points(
      std::move(positions), options.normals ? vectors_of(*options.normals) : Positions{},
      static_cast<std::uint32_t>(num_points / height), static_cast<std::uint32_t>(height), input);
  cloud.triangles = std::move(triangles);
  return finish(std::move(cloud), input);
}

Result<Cloud> copy_depths(const Input& input, const ArrayView& depths) {
  TRIVET_TRY(check_array(input, "depths", depths));
  if (depths.num_dimensions != 2) {
    return Error{ErrorCode::usage, fmt::format("{}: depths: expected the shape (height, width), "
                                               "found {}",
                                               input.file.string(), shape_text(depths))};
  }
  const std::size_t height = depths.shape[0], width = depths.shape[1];
  TRIVET_TRY(check_pixels(input, width, height));
  TRIVET_TRY_ASSIGN(const Camera camera, depth_camera(input, width, height));
  Result<Cloud> cloud = with_numbers(depths, [&](auto number) {
    return back_project(input, static_cast<std::uint32_t>(width),
                        static_cast<std::uint32_t>(height), camera, [&](std::size_t pixel) {
                          return static_cast<double>(number(pixel / width, pixel % width, 0));
                        });
  });
  return cloud ? finish(*std::move(cloud), input) : std::move(cloud);
}

ReadOptions read_options(const MemoryCloudOptions& options) {
  ReadOptions read;
  read.max_points = options.max_points;
  read.max_pixels = options.max_pixels;
  read.keep_origin = options.keep_origin;
  return read;
}

}  // namespace

Result<Cloud> cloud_from_points(const ArrayView& xyz, const MemoryCloudOptions& options) {
  const std::filesystem::path name(options.name);
  const ReadOptions read = read_options(options);
  const Input input{name, {}, read};
  return formats::within_memory(input, [&] { return copy_points(input, xyz, options); });
}

Result<Cloud> cloud_from_depths(const ArrayView& depths, const Camera& camera,
                                const MemoryCloudOptions& options) {
  const std::filesystem::path name(options.name);
  ReadOptions read = read_options(options);
  read.camera = camera;
  const Input input{name, {}, read};
  return formats::within_memory(input, [&] { return copy_depths(input, depths); });
}

}  // namespace trivet
