#include "python/src/arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace trivet::python {
namespace {

template <class T>
using Columns = std::array<std::span<const T>, 3>;

template <class T>
py::array copied(const Columns<T>& columns) {
  const std::size_t n = columns[0].size();
  py::array_t<T> copy({static_cast<py::ssize_t>(n), py::ssize_t{3}});
  auto rows = copy.template mutable_unchecked<2>();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      rows(static_cast<py::ssize_t>(i), static_cast<py::ssize_t>(c)) = columns[c][i];
  }
  return copy;
}

template <class T>
py::array viewed(const Columns<T>& columns, const py::object& owner) {
  const auto n = static_cast<py::ssize_t>(columns[0].size());
  const auto step = columns[1].data() - columns[0].data();
  if (n == 0 || columns[2].data() - columns[1].data() != step) return copied<T>(columns);
  const auto size = static_cast<py::ssize_t>(sizeof(T));
  py::array_t<T> view({n, py::ssize_t{3}}, {size, size * static_cast<py::ssize_t>(step)},
                      columns[0].data(), owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

Columns<float> columns_of(PointsView points) { return {points.x, points.y, points.z}; }
Columns<std::uint32_t> columns_of(TrianglesView triangles) {
  return {triangles.a, triangles.b, triangles.c};
}

FilePose in_doubles(const Pose& pose) { return pose.cast<double>(); }
const FilePose& in_doubles(const FilePose& pose) { return pose; }

template <class SomePose>
py::array_t<double> stacked(const std::vector<SomePose>& poses) {
  py::array_t<double> out({static_cast<py::ssize_t>(poses.size()), py::ssize_t{4}, py::ssize_t{4}});
  auto to = out.mutable_unchecked<3>();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::Matrix4d matrix = in_doubles(poses[k]).matrix();
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column)
        to(static_cast<py::ssize_t>(k), row, column) = matrix(row, column);
    }
  }
  return out;
}

/// Any array or sequence as doubles; none if it is not an array of numbers.
py::array_t<double> numbers_of(const py::handle& value) {
  const py::array_t<double> numbers =
      py::array_t<double>::ensure(py::reinterpret_borrow<py::object>(value));
  if (!numbers) PyErr_Clear();
  return numbers;
}

}  // namespace

py::array rows_of(PointsView points) { return copied(columns_of(points)); }
py::array rows_of(TrianglesView triangles) { return copied(columns_of(triangles)); }

py::array rows_within(PointsView points, const py::object& owner) {
  return viewed(columns_of(points), owner);
}
py::array rows_within(TrianglesView triangles, const py::object& owner) {
  return viewed(columns_of(triangles), owner);
}

py::array_t<double> matrix_of(const FilePose& pose) {
  py::array_t<double> out({4, 4});
  auto to = out.mutable_unchecked<2>();
  const Eigen::Matrix4d matrix = pose.matrix();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) to(row, column) = matrix(row, column);
  }
  return out;
}

py::array_t<double> matrices_of(const std::vector<Pose>& poses) { return stacked(poses); }
py::array_t<double> matrices_of(const std::vector<FilePose>& poses) { return stacked(poses); }

py::array_t<double> vector_of(const Eigen::Vector3d& vector) {
  py::array_t<double> out(3);
  std::ranges::copy(std::span(vector.data(), 3), out.mutable_data());
  return out;
}

FilePose pose_of(const py::handle& matrix, const char* what) {
  constexpr double kTolerance = 1e-3;
  const py::array_t<double> numbers = numbers_of(matrix);
  if (!numbers || numbers.ndim() != 2 || numbers.shape(0) != 4 || numbers.shape(1) != 4)
    raise({ErrorCode::usage, fmt::format("{}: expected a (4, 4) matrix", what)});
  Eigen::Matrix4d values;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) values(row, column) = numbers.at(row, column);
  }
  const Eigen::Matrix3d rotation = values.topLeftCorner<3, 3>();
  const bool rigid = values.allFinite() && rotation.determinant() > 0 &&
                     (rotation.transpose() * rotation).isIdentity(kTolerance) &&
                     values.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1));
  if (!rigid) {
    raise({ErrorCode::usage,
           fmt::format("{}: expected a rotation and a translation above a row 0 0 0 1", what)});
  }
  FilePose pose = FilePose::Identity();
  pose.linear() = rotation;
  pose.translation() = values.topRightCorner<3, 1>();
  return pose;
}

Eigen::Vector3d vector_from(const py::handle& numbers, const char* what) {
  const py::array_t<double> values = numbers_of(numbers);
  if (!values || values.ndim() != 1 || values.size() != 3)
    raise({ErrorCode::usage, fmt::format("{}: expected 3 numbers", what)});
  return {values.at(0), values.at(1), values.at(2)};
}

}  // namespace trivet::python
