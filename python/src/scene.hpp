/// Scenes and models from NumPy arrays and files.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>

#include "engine/recognition/recognize.hpp"
#include "python/src/call.hpp"
#include "storage/formats/memory_cloud.hpp"

namespace trivet::python {

/// A scene in memory, with its sensor.
struct Scene {
  std::shared_ptr<const Cloud> cloud;
  SceneInput input;  ///< input without a scale
};

/// Parses "m", "mm" or None. Raises UsageError.
std::optional<LengthUnit> unit_from(const py::object& unit);

/// A view of an array for the engine. Arrays of other types are converted first, and `converted`
/// keeps the results alive.
ArrayView view_from(const py::object& array, const char* what, py::list& converted);

/// Makes a cloud of points (n, 3) or (height, width, 3); normals and triangles may be None.
/// Raises UsageError, DataError.
Cloud cloud_from(const py::object& points, const py::object& normals, const py::object& triangles,
                 const std::string& name, bool keep_origin);

void add_scene(py::module_& module);

}  // namespace trivet::python
