/// Scenes and models out of NumPy arrays and files.
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

/// A scene in memory, and what its sensor was.
struct Scene {
  std::shared_ptr<const Cloud> cloud;
  SceneInput input;  ///< without its scale
};

/// "m", "mm" or None. Raises UsageError.
std::optional<LengthUnit> unit_from(const py::object& unit);

/// Arrays as the engine reads them, which `converted` keeps alive: those of types that it does not
/// read are converted first.
ArrayView view_from(const py::object& array, const char* what, py::list& converted);

/// Points (n, 3) or (height, width, 3); normals and triangles may be None. Raises UsageError,
/// DataError.
Cloud cloud_from(const py::object& points, const py::object& normals, const py::object& triangles,
                 const std::string& name, bool keep_origin);

void add_scene(py::module_& module);

}  // namespace trivet::python
