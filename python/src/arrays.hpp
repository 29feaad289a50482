/// Converts columns and poses to NumPy arrays.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <span>
#include <vector>

#include "python/src/call.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/file_pose.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::python {

/// Columns as rows: (n, 3), a copy.
py::array rows_of(PointsView points);
py::array rows_of(TrianglesView triangles);
/// (n, 3), read only. A view of the columns if they are evenly spaced, as in a library's file, else
/// a copy.
///
/// owner  keeps the columns alive
py::array rows_within(PointsView points, const py::object& owner);
py::array rows_within(TrianglesView triangles, const py::object& owner);

/// (n,) or, for rows of n numbers, (n, width): a view of the memory, read only.
template <class T>
py::array view_of(std::span<const T> values, const py::object& owner, std::size_t width = 0) {
  const auto n = static_cast<py::ssize_t>(width == 0 ? values.size() : values.size() / width);
  std::vector<py::ssize_t> shape{n};
  if (width > 0) shape.push_back(static_cast<py::ssize_t>(width));
  py::array_t<T> view(shape, values.data(), owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

py::array_t<double> matrix_of(const FilePose& pose);                  ///< (4, 4)
py::array_t<double> matrices_of(const std::vector<Pose>& poses);      ///< (n, 4, 4)
py::array_t<double> matrices_of(const std::vector<FilePose>& poses);  ///< (n, 4, 4)
py::array_t<double> vector_of(const Eigen::Vector3d& vector);         ///< (3,)

/// Raises UsageError: not (4, 4), or not a rotation and translation.
FilePose pose_of(const py::handle& matrix, const char* what);
/// Raises UsageError: not 3 numbers.
Eigen::Vector3d vector_from(const py::handle& numbers, const char* what);

}  // namespace trivet::python
