#include "python/src/scan.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/inputs/inputs.hpp"
#include "engine/simulation/render_scenes.hpp"
#include "python/src/arrays.hpp"
#include "python/src/call.hpp"
#include "python/src/options.hpp"
#include "python/src/scene.hpp"

namespace trivet::python {
namespace {

/// A scanner and its models.
struct Scanner {
  std::shared_ptr<const std::vector<ScanModel>> models;
  LengthUnit unit = LengthUnit::meter;
  ScanOptions options;
  std::shared_ptr<const VirtualScanner> scanner;
};

Scanner make_scanner(const std::vector<std::string>& files, std::size_t num_parts,
                     const std::vector<std::string>& families, const py::object& unit,
                     double diameter, bool metal, const py::dict& keywords) {
  ScanOptions options;
  set_options(keywords, options);
  apps::ModelInputs inputs = unwrap(apps::collect_models(files));
  unit_from(unit);
  const LengthUnit length =
      unwrap(apps::choose_unit(inputs, unit.is_none() ? std::string() : unit.cast<std::string>()));
  return unwrap(interruptibly([&](const std::stop_token&) -> Result<Scanner> {
    Result<std::vector<ScanModel>> models =
        read_scan_models(inputs.sources, length, {static_cast<float>(diameter), metal});
    if (!models) return models.error();
    for (ScanModel& part : make_scan_models(num_parts, options.seed, families))
      models->push_back(std::move(part));
    auto kept = std::make_shared<const std::vector<ScanModel>>(std::move(*models));
    Result<VirtualScanner> scanner = VirtualScanner::create(*kept, length, options);
    if (!scanner) return scanner.error();
    return Scanner{kept, length, options,
                   std::make_shared<const VirtualScanner>(std::move(*scanner))};
  }));
}

py::list truth_of(const RenderedScene& scene) {
  py::list all;
  for (const TruthInstance& instance : scene.truth) {
    py::dict one;
    one["model"] = instance.model;
    one["pose"] = matrix_of(instance.file_pose());
    one["visible_fraction"] = instance.visible_fraction;
    one["occlusion"] = instance.occlusion;
    one["clutter"] = instance.clutter;
    one["ignore"] = instance.ignore;
    all.append(one);
  }
  return all;
}

py::dict scan(const Scanner& self, std::uint32_t index) {
  const RenderedScene scene =
      unwrap(interruptibly([&](const std::stop_token&) { return self.scanner->scan(index); }));
  py::array_t<std::uint16_t> depth(
      {static_cast<py::ssize_t>(scene.height), static_cast<py::ssize_t>(scene.width)});
  std::ranges::copy(scene.depths, depth.mutable_data());
  const Camera& camera = scene.camera;
  py::dict out;
  out["depth"] = depth;
  out["camera"] = py::make_tuple(camera.fx, camera.fy, camera.cx, camera.cy);
  out["depth_scale"] = camera.depth_scale;
  out["truth"] = truth_of(scene);
  return out;
}

/// (name, vertices, triangles) of each, in the requested unit.
py::list models_of(const Scanner& self) {
  const float scale = static_cast<float>(unit_scale(LengthUnit::meter, self.unit));
  py::list all;
  for (const ScanModel& model : *self.models) {
    Points vertices = model.vertices;
    const PointsSpan points = vertices;
    for (std::span<float> column : {points.x, points.y, points.z}) {
      for (float& value : column) value *= scale;
    }
    all.append(py::make_tuple(model.name, rows_of(PointsView(vertices)),
                              rows_of(TrianglesView(model.triangles))));
  }
  return all;
}

}  // namespace

void add_scan(py::module_& module) {
  py::class_<Scanner>(module, "_Scanner")
      .def(py::init(&make_scanner))
      .def_property_readonly("num_scenes",
                             [](const Scanner& self) { return self.options.num_scenes; })
      .def_property_readonly("models", &models_of)
      .def("scan", &scan);
  module.def("_scan_options", &describe_options<ScanOptions>);
}

}  // namespace trivet::python
