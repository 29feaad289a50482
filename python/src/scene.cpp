#include "python/src/scene.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/meshing/surface_from_points.hpp"
#include "python/src/arrays.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::python {
namespace {

template <class T>
bool set_view(const py::array& array, ArrayView& view) {
  if (!py::isinstance<py::array_t<T>>(array)) return false;
  const auto size = static_cast<py::ssize_t>(sizeof(T));
  for (py::ssize_t d = 0; d < array.ndim(); ++d) {
    if (array.strides(d) % size != 0) return false;
    view.shape[static_cast<std::size_t>(d)] = static_cast<std::size_t>(array.shape(d));
    view.strides[static_cast<std::size_t>(d)] = array.strides(d) / size;
  }
  if (reinterpret_cast<std::uintptr_t>(array.data()) % alignof(T) != 0) return false;
  view.data = static_cast<const T*>(array.data());
  return true;
}

/// The text that read_camera accepts: numbers, or the contents of a camera file.
std::string camera_text(const py::handle& given) {
  if (py::isinstance<py::dict>(given)) {
    const py::cpp_function to_list([](const py::object& value) { return value.attr("tolist")(); });
    return py::module_::import("json")
        .attr("dumps")(given, py::arg("default") = to_list)
        .cast<std::string>();
  }
  using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const Rows values = Rows::ensure(py::reinterpret_borrow<py::object>(given));
  if (!values) PyErr_Clear();
  const bool four = values && values.ndim() == 1 && values.size() == 4;
  const bool matrix = values && values.ndim() == 2 && values.shape(0) == 3 && values.shape(1) == 3;
  if (!four && !matrix) {
    raise({ErrorCode::usage,
           "camera: expected (fx, fy, cx, cy), a (3, 3) matrix, a dictionary as of a camera file, "
           "or the name of one"});
  }
  return fmt::format(
      "{}", fmt::join(std::span(values.data(), static_cast<std::size_t>(values.size())), " "));
}

/// Raises UsageError and DataError.
Camera camera_from(const py::handle& given, double depth_scale) {
  const bool is_file = py::isinstance<py::str>(given) || py::hasattr(given, "__fspath__");
  Camera camera;
  if (is_file) {
    camera =
        unwrap(read_camera(py::module_::import("os").attr("fspath")(given).cast<std::string>()));
  } else {
    const std::string text = camera_text(given);
    camera = unwrap(read_camera(std::as_bytes(std::span(text)), "camera"));
  }
  if (camera.depth_scale != 1 && depth_scale != 1)
    raise({ErrorCode::usage, "depth_scale: expected it once, found it in the camera, too"});
  camera.depth_scale *= depth_scale;
  return camera;
}

SceneInput input_of(const std::string& name, const py::object& viewpoint, bool closed_surface,
                    const py::object& unit) {
  SceneInput input;
  input.file = name;
  input.closed_surface = closed_surface;
  input.unit = unit_from(unit);
  if (!viewpoint.is_none()) input.viewpoint = vector_from(viewpoint, "viewpoint");
  return input;
}

Scene scene_of_points(const py::object& points, const py::object& normals,
                      const py::object& triangles, const py::object& viewpoint, bool closed_surface,
                      const py::object& unit, const std::string& name) {
  Cloud cloud = cloud_from(points, normals, triangles, name, false);
  return {std::make_shared<const Cloud>(std::move(cloud)),
          input_of(name, viewpoint, closed_surface, unit)};
}

Scene scene_of_depths(const py::object& depth, const py::object& camera, double depth_scale,
                      const py::object& unit, const std::string& name) {
  py::list converted;
  const ArrayView view = view_from(depth, "depth", converted);
  const Camera pinhole = camera_from(camera, depth_scale);
  SceneInput input = input_of(name, py::none(), false, unit);
  input.camera = pinhole;
  const auto cloud = [&] {
    const py::gil_scoped_release released;
    return cloud_from_depths(view, pinhole, {.name = name});
  }();
  return {std::make_shared<const Cloud>(unwrap(cloud)), std::move(input)};
}

Scene scene_of_file(const py::object& path, const py::object& camera, double depth_scale,
                    const py::object& viewpoint, bool closed_surface, const py::object& unit) {
  const auto file = py::module_::import("os").attr("fsencode")(path).cast<std::string>();
  SceneInput input = input_of(file, viewpoint, closed_surface, unit);
  if (!camera.is_none()) input.camera = camera_from(camera, depth_scale);
  Result<Cloud> cloud = [&] {
    const py::gil_scoped_release released;
    return read_scene(input);
  }();
  return {std::make_shared<const Cloud>(unwrap(std::move(cloud))), std::move(input)};
}

py::object grid_of(const Scene& scene, const py::object& owner) {
  if (!scene.cloud->grid) return py::none();
  const PixelGrid& grid = *scene.cloud->grid;
  return view_of<std::int32_t>(grid.point_index, owner, grid.width);
}

py::dict mesh_of(const Scene& scene, const py::object& method, const py::object& viewpoint) {
  SurfaceOptions options;
  if (!viewpoint.is_none()) options.viewpoint = vector_from(viewpoint, "viewpoint");
  if (!method.is_none()) {
    const auto name = method.cast<std::string>();
    for (const SurfaceMethodName& known : kSurfaceMethods) {
      if (known.name == name) options.method = known.method;
    }
    if (!options.method)
      raise({ErrorCode::usage,
             fmt::format("method: expected faces, grid or greedy, found '{}'", name)});
  }
  unwrap(validate(options));
  const Surface surface = unwrap([&] {
    const py::gil_scoped_release released;
    return surface_from_points(*scene.cloud, scene.input.file.string(), options);
  }());
  py::dict out;
  out["vertices"] = rows_of(surface.mesh.points);
  out["triangles"] = rows_of(surface.mesh.triangles);
  out["normals"] = surface.mesh.normals.empty() ? py::object(py::none())
                                                : py::object(rows_of(surface.mesh.normals));
  out["offset"] = vector_of(surface.mesh.offset);
  for (const SurfaceMethodName& known : kSurfaceMethods) {
    if (known.method == surface.method) out["method"] = std::string(known.name);
  }
  out["open_share"] = surface.open_share;
  out["warning"] = surface.warning;
  return out;
}

void write_mesh(const std::string& file, const py::object& vertices, const py::object& triangles,
                const py::object& normals) {
  const Cloud cloud = cloud_from(vertices, normals, triangles, file, true);
  const Result<void> written = [&] {
    const py::gil_scoped_release released;
    return write_ply(file, cloud);
  }();
  unwrap(written);
}

}  // namespace

std::optional<LengthUnit> unit_from(const py::object& unit) {
  if (unit.is_none()) return std::nullopt;
  const auto name = py::str(unit).cast<std::string>();
  if (name == "m") return LengthUnit::meter;
  if (name == "mm") return LengthUnit::millimeter;
  raise({ErrorCode::usage, fmt::format("unit: expected 'm' or 'mm', found '{}'", name)});
}

ArrayView view_from(const py::object& given, const char* what, py::list& converted) {
  py::array array = py::array::ensure(given);
  if (!array) {
    PyErr_Clear();
    raise(
        {ErrorCode::usage, fmt::format("{}: expected an array of numbers, found {}", what,
                                       py::type::of(given).attr("__name__").cast<std::string>())});
  }
  ArrayView view;
  if (array.ndim() < 1 || array.ndim() > 3) {
    raise({ErrorCode::usage,
           fmt::format("{}: expected 2 or 3 dimensions, found {}", what, array.ndim())});
  }
  view.num_dimensions = static_cast<std::size_t>(array.ndim());
  view.shape = {1, 1, 1};
  view.strides = {1, 1, 1};
  bool is_set = set_view<float>(array, view) || set_view<double>(array, view) ||
                set_view<std::uint16_t>(array, view) || set_view<std::int32_t>(array, view) ||
                set_view<std::uint32_t>(array, view) || set_view<std::int64_t>(array, view);
  if (!is_set) {
    array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
    if (!array) {
      PyErr_Clear();
      raise({ErrorCode::usage, fmt::format("{}: expected an array of numbers", what)});
    }
    set_view<double>(array, view);
  }
  converted.append(array);
  return view;
}

Cloud cloud_from(const py::object& points, const py::object& normals, const py::object& triangles,
                 const std::string& name, bool keep_origin) {
  py::list converted;
  MemoryCloudOptions options{.name = name, .keep_origin = keep_origin};
  const ArrayView view = view_from(points, "points", converted);
  if (!normals.is_none()) options.normals = view_from(normals, "normals", converted);
  if (!triangles.is_none()) options.triangles = view_from(triangles, "triangles", converted);
  Result<Cloud> cloud = [&] {
    const py::gil_scoped_release released;
    return cloud_from_points(view, options);
  }();
  return unwrap(std::move(cloud));
}

void add_scene(py::module_& module) {
  py::class_<Scene>(module, "Scene")
      .def_static("from_points", &scene_of_points, py::arg("points"), py::kw_only(),
                  py::arg("normals") = py::none(), py::arg("triangles") = py::none(),
                  py::arg("viewpoint") = py::none(), py::arg("closed_surface") = false,
                  py::arg("unit") = py::none(), py::arg("name") = "array")
      .def_static("from_depth", &scene_of_depths, py::arg("depth"), py::arg("camera"),
                  py::kw_only(), py::arg("depth_scale") = 1.0, py::arg("unit") = py::none(),
                  py::arg("name") = "array")
      .def_static("read", &scene_of_file, py::arg("file"), py::kw_only(),
                  py::arg("camera") = py::none(), py::arg("depth_scale") = 1.0,
                  py::arg("viewpoint") = py::none(), py::arg("closed_surface") = false,
                  py::arg("unit") = py::none())
      .def("__len__", [](const Scene& scene) { return scene.cloud->points.size(); })
      .def_property_readonly(
          "name", [](const Scene& scene) { return path_text(scene.input.file.string()); })
      .def_property_readonly("num_invalid",
                             [](const Scene& scene) { return scene.cloud->num_invalid; })
      .def_property_readonly("offset",
                             [](const Scene& scene) { return vector_of(scene.cloud->offset); })
      .def_property_readonly("points",
                             [](const Scene& scene) { return rows_of(scene.cloud->points); })
      .def_property_readonly(
          "pixels", [](const py::object& self) { return grid_of(self.cast<const Scene&>(), self); })
      .def("_mesh", &mesh_of);
  module.def("_write_mesh", &write_mesh);
}

}  // namespace trivet::python
