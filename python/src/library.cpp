#include "python/src/library.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <string>

#include "apps/inputs/inputs.hpp"
#include "python/src/arrays.hpp"
#include "python/src/call.hpp"
#include "storage/library/library.hpp"

namespace trivet::python {
namespace {

/// A model of an open library.
struct ModelHandle {
  std::shared_ptr<const Recognizer> recognizer;
  std::uint32_t index = 0;

  const ModelInfo& model() const { return recognizer->library().models[index]; }
};

OpenLibrary open(const std::string& file, const std::string& calibration, std::uint32_t memory_mb,
                 bool verify) {
  const apps::OpenOptions opening{calibration, memory_mb, verify};
  Result<Recognizer> opened = [&] {
    const py::gil_scoped_release released;
    return apps::open_recognizer(file, opening);
  }();
  return {std::make_shared<const Recognizer>(unwrap(std::move(opened))), file, opening};
}

ModelHandle find_model(const OpenLibrary& self, const std::string& name) {
  const auto& models = self.library().models;
  const auto found = std::ranges::lower_bound(models, name, {}, &Model::name);
  if (found == models.end() || found->name != name)
    throw py::key_error(fmt::format("{}: no model '{}'", self.file, name));
  return {self.recognizer, static_cast<std::uint32_t>(found - models.begin())};
}

std::vector<std::string> names_of(const OpenLibrary& self) {
  std::vector<std::string> names;
  for (const ModelInfo& model : self.library().models) names.push_back(model.name);
  return names;
}

py::object axis_of(const std::optional<Symmetry::Axis>& axis) {
  if (!axis) return py::none();
  return py::make_tuple(vector_of(Eigen::Vector3f(axis->direction).cast<double>()),
                        vector_of(Eigen::Vector3f(axis->point).cast<double>()));
}

/// A property with columns of a part, which is verified when it is first read. Raises DataError.
///
/// part  member of Library that gives it
template <class Part, class Get>
auto columns(Result<const Part*> (Library::*part)(std::uint32_t) const, Get&& get) {
  return [part, get](const py::object& self) -> py::object {
    const auto& handle = self.cast<const ModelHandle&>();
    const Part* const read = unwrap((handle.recognizer->library().*part)(handle.index));
    return get(*read, self);
  };
}

py::list features_of(const ModelFeatures& model, const py::object& owner) {
  py::list levels;
  for (const TriSpinFeatures& features : model.features) {
    py::dict level;
    level["resolution"] = features.resolution;
    level["keypoints"] = rows_within(features.keypoints, owner);
    const std::span<const FrameRows> frames = features.frames;
    level["frames"] = view_of<float>(
        {frames.empty() ? nullptr : frames.front().data(), 9 * frames.size()}, owner, 9);
    level["codes"] = view_of<std::uint8_t>(features.codes, owner,
                                           std::max<std::size_t>(features.num_components, 1));
    levels.append(level);
  }
  return levels;
}

py::dict pairs_of(const ModelPairs& model, const py::object& owner) {
  const PpfTableView& table = model.ppf;
  const std::span<const PpfEntry> entries = table.entries;
  py::dict out;
  out["points"] = rows_within(model.ppf_points, owner);
  out["normals"] = rows_within(model.ppf_normals, owner);
  out["num_references"] = table.num_references;
  out["distance_step"] = table.quantization.distance_step;
  out["num_distance_bins"] = table.quantization.num_distance_bins;
  out["num_angle_bins"] = table.quantization.num_angle_bins;
  out["offsets"] = view_of<std::uint32_t>(table.offsets, owner);
  out["entries"] = view_of<std::uint16_t>(
      {reinterpret_cast<const std::uint16_t*>(entries.data()), 2 * entries.size()}, owner, 2);
  return out;
}

void add_model(py::module_& module) {
  using Handle = ModelHandle;
  const auto has = [](auto member) {
    return [member](const Handle& self) { return self.model().*member; };
  };
  py::class_<Handle>(module, "Model")
      .def_property_readonly("name", has(&Model::name))
      .def_property_readonly("source", has(&Model::source))
      .def_property_readonly("source_xxh3", has(&Model::source_xxh3))
      .def_property_readonly("fingerprint", has(&Model::fingerprint))
      .def_property_readonly("diameter", has(&Model::diameter))
      .def_property_readonly("sample_spacing", has(&Model::sample_spacing))
      .def_property_readonly(
          "center",
          [](const Handle& self) { return vector_of(self.model().center.cast<double>()); })
      .def_property_readonly(
          "symmetries", [](const Handle& self) { return matrices_of(self.model().symmetry.poses); })
      .def_property_readonly("symmetry_axis",
                             [](const Handle& self) { return axis_of(self.model().symmetry.axis); })
      .def_property_readonly(
          "near_symmetries",
          [](const Handle& self) { return matrices_of(self.model().near_symmetries); })
      .def_property_readonly("near_axis",
                             [](const Handle& self) { return axis_of(self.model().near_axis); })
      .def_property_readonly("vertices", columns(&Library::surface,
                                                 [](const ModelSurface& m, auto& self) {
                                                   return rows_within(m.vertices, self);
                                                 }))
      .def_property_readonly("triangles", columns(&Library::surface,
                                                  [](const ModelSurface& m, auto& self) {
                                                    return rows_within(m.triangles, self);
                                                  }))
      .def_property_readonly("samples", columns(&Library::samples,
                                                [](const ModelSamples& m, auto& self) {
                                                  return rows_within(m.samples, self);
                                                }))
      .def_property_readonly("sample_normals", columns(&Library::samples,
                                                       [](const ModelSamples& m, auto& self) {
                                                         return rows_within(m.sample_normals, self);
                                                       }))
      .def_property_readonly(
          "pairs", columns(&Library::pairs,
                           [](const ModelPairs& m, auto& self) { return pairs_of(m, self); }))
      .def_property_readonly("features",
                             columns(&Library::features, [](const ModelFeatures& m, auto& self) {
                               return features_of(m, self);
                             }));
}

}  // namespace

void add_library(py::module_& module) {
  add_model(module);
  py::class_<OpenLibrary>(module, "Library")
      .def(py::init(&open), py::arg("file"), py::kw_only(), py::arg("calibration") = "",
           py::arg("memory_mb") = MemoryBound::kDefault >> 20U, py::arg("verify") = false)
      .def(py::pickle(
          [](const OpenLibrary& self) {
            return py::make_tuple(py::bytes(self.file), self.opening.calibration,
                                  self.opening.memory_mb);
          },
          [](const py::tuple& how) {
            return open(how[0].cast<std::string>(), how[1].cast<std::string>(),
                        how[2].cast<std::uint32_t>(), false);
          }))
      .def("__len__", [](const OpenLibrary& self) { return self.library().models.size(); })
      .def("__getitem__", &find_model)
      .def("__contains__",
           [](const OpenLibrary& self, const std::string& name) {
             return std::ranges::binary_search(self.library().models, name, {}, &Model::name);
           })
      .def("__iter__", [](const OpenLibrary& self) { return py::iter(py::cast(names_of(self))); })
      .def_property_readonly("names", &names_of)
      .def_property_readonly("file", [](const OpenLibrary& self) { return path_text(self.file); })
      .def_property_readonly(
          "unit", [](const OpenLibrary& self) { return unit_name(self.library().header.unit); })
      .def_property_readonly("producer",
                             [](const OpenLibrary& self) { return self.library().header.producer; })
      .def_property_readonly(
          "_parameters", [](const OpenLibrary& self) { return self.library().header.parameters; })
      .def("verify", [](const OpenLibrary& self) {
        const Result<void> good = [&] {
          const py::gil_scoped_release released;
          return self.library().check_all();
        }();
        unwrap(good);
      });
}

}  // namespace trivet::python
