#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <limits>

#include "storage/common/stop.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/arrange_points.hpp"
#include "storage/formats/depth_image.hpp"
#include "storage/formats/npy_header.hpp"
#include "storage/formats/positions.hpp"
#include "storage/formats/readers.hpp"

namespace trivet::formats {
namespace {

/// Tables of points have few columns, depth images many rows and columns.
constexpr std::uint64_t kMostColumns = 15;

/// The array as rows of `columns` values, whatever its order.
class Table {
 public:
  Table(const Input& input, const NpyHeader& header, std::uint64_t columns)
      : body_(input.bytes.data() + header.body_begin), header_(header), columns_(columns) {
    strides_.assign(header.shape.size(), 1);
    if (header.fortran_order) {
      for (std::size_t d = 1; d < strides_.size(); ++d)
        strides_[d] = strides_[d - 1] * header.shape[d - 1];
    } else {
      for (std::size_t d = strides_.size() - 1; d > 0; --d)
        strides_[d - 1] = strides_[d] * header.shape[d];
    }
  }

  /// Value `row * columns + column` of the array in C order.
  double value(std::size_t row, std::size_t column) const {
    std::uint64_t rest = row * columns_ + column, place = 0;
    for (std::size_t d = strides_.size(); d > 0; --d) {
      place += rest % header_.shape[d - 1] * strides_[d - 1];
      rest /= header_.shape[d - 1];
    }
    return load(body_ + place * size_of(header_.type), header_.type, header_.order);
  }
  Eigen::Vector3d vector(std::size_t row, std::size_t first) const {
    return {value(row, first), value(row, first + 1), value(row, first + 2)};
  }

 private:
  const std::byte* body_;
  const NpyHeader& header_;
  std::uint64_t columns_;
  std::vector<std::uint64_t> strides_;
};

/// Columns four to six must be directions or zero: they may also hold colors.
Result<void> check_normal(const Input& input, const Eigen::Vector3d& normal, std::size_t row) {
  const double length = normal.norm();
  if (!std::isfinite(length) || length == 0 || std::abs(length - 1) < 0.1) return {};
  return input.refuse(
      fmt::format("row {}: expected a unit normal in columns 4 to 6, found a vector of length "
                  "{:.3g}; save the first three columns alone if these are colors",
                  row, length));
}

Result<Cloud> read_points(const Input& input, const NpyHeader& header) {
  const std::uint64_t columns = header.shape.back();
  const std::uint64_t count =
      (input.bytes.size() - header.body_begin) / size_of(header.type) / columns;
  if (count > input.max_points()) return input.refuse_count(count);

  const Table table(input, header, columns);
  Positions positions, normals;
  StopCheck check_stop(1 << 18);
  for (std::size_t i = 0; i < count; ++i) {
    check_stop();
    positions.push_back(table.vector(i, 0));
    if (columns != 6) continue;
    const Eigen::Vector3d normal = table.vector(i, 3);
    TRIVET_TRY(check_normal(input, normal, i));
    normals.push_back(normal);
  }
  const bool image = header.shape.size() == 3;
  const std::uint64_t height = image ? header.shape[0] : 1;
  return arrange_points(std::move(positions), std::move(normals),
                        static_cast<std::uint32_t>(count / height),
                        static_cast<std::uint32_t>(height), input);
}

Result<Cloud> read_depths(const Input& input, const NpyHeader& header) {
  const std::uint64_t height = header.shape[0], width = header.shape[1];
  TRIVET_TRY(check_pixels(input, width, height));
  TRIVET_TRY_ASSIGN(const auto camera, depth_camera(input, width, height));
  const Table table(input, header, 1);
  return back_project(input, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height),
                      camera, [&](std::size_t pixel) { return table.value(pixel, 0); });
}

}  // namespace

Result<Cloud> read_npy(const Input& input) {
  TRIVET_TRY_ASSIGN(const auto header, parse_npy_header(input));
  const auto& shape = header.shape;
  const bool vectors = !shape.empty() && (shape.back() == 3 || shape.back() == 6);
  if (shape.size() == 3 && vectors && header.type == Scalar::uint8) {
    return input.refuse("expected points or depths, found a picture: 8-bit values in three colors");
  }
  if ((shape.size() == 2 || shape.size() == 3) && vectors) return read_points(input, header);
  const bool image = shape.size() == 2 || (shape.size() == 3 && shape[2] == 1);
  if (image && shape[0] > kMostColumns && shape[1] > kMostColumns)
    return read_depths(input, header);
  return input.refuse(fmt::format(
      "expected the shape (N, 3) or (N, 6) of points with or without normals, (height, width, 3) "
      "of "
      "an organized cloud, or (height, width) of depths, both above {}, found ({}); save a[:, :3] "
      "of wider tables, and a.T of those that lie down",
      kMostColumns, fmt::join(shape, ", ")));
}

}  // namespace trivet::formats
