#include "python/src/recognize.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <string>
#include <vector>

#include "apps/report/pictures.hpp"
#include "apps/results/detections_json.hpp"
#include "engine/evaluation/evaluation_meshes.hpp"
#include "engine/options/presets.hpp"
#include "engine/pictures/draw_scene.hpp"
#include "python/src/arrays.hpp"
#include "python/src/call.hpp"
#include "python/src/library.hpp"
#include "python/src/options.hpp"
#include "python/src/scene.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::python {
namespace {

/// The result, and everything needed to draw it.
struct Recognized {
  std::shared_ptr<const Recognizer> recognizer;
  Scene scene;
  RecognizeOptions options;
  SceneResult result;

  py::array_t<double> place(const Pose& pose) const {
    return matrix_of(in_file_frame(pose, result.offset));
  }
};
using RecognizedPtr = std::shared_ptr<const Recognized>;

template <class Kind>
struct Part {  // one of the detections, or of the rejected poses
  RecognizedPtr all;
  const Kind* one;
};
using DetectionHandle = Part<Detection>;
using RejectedHandle = Part<RejectedPose>;

template <class Kind>
std::vector<Part<Kind>> parts_of(const RecognizedPtr& all, const std::vector<Kind>& kinds) {
  std::vector<Part<Kind>> out;
  for (const Kind& kind : kinds) out.push_back({all, &kind});
  return out;
}

Recognized recognize_scene(const OpenLibrary& library, const Scene& scene,
                           const std::string& preset, Stopper* stopper, const py::dict& keywords) {
  Recognized out{library.recognizer, scene, recognize_options(preset, keywords), {}};
  SceneInput& input = out.scene.input;
  const LengthUnit unit = library.library().header.unit;
  input.scale = unit_scale(input.unit.value_or(unit), unit);
  out.result = unwrap(interruptibly(
      [&](std::stop_token stop) {
        return recognize(*library.recognizer, *scene.cloud, input, out.options, std::move(stop));
      },
      stopper ? stopper->source : std::stop_source()));
  return out;
}

std::string json_of(const Recognized& self) {
  return json_text(apps::scene_json(self.scene.input.file.string(), self.result,
                                    self.recognizer->score(), self.options),
                   2);
}

py::array_t<double> alternatives_of(const DetectionHandle& self) {
  std::vector<FilePose> poses;
  for (const Pose& pose : self.one->alternatives)
    poses.push_back(in_file_frame(pose, self.all->result.offset));
  return matrices_of(poses);
}

py::list candidates_of(const DetectionHandle& self) {
  const Eigen::Vector3d& offset = self.all->result.offset;
  py::list out;
  for (const Candidate& candidate : self.one->candidates) {
    py::dict one;
    one["model"] = candidate.model;
    one["share"] = candidate.share;
    if (candidate.differs) {
      py::dict differs;
      differs["center"] =
          vector_of(Eigen::Vector3d(candidate.differs->center.cast<double>() + offset));
      differs["size"] = candidate.differs->size;
      differs["deviation"] = candidate.differs->deviation;
      differs["look_from"] =
          vector_of(Eigen::Vector3d(candidate.differs->look_from.cast<double>()));
      one["T_scene_model"] = self.all->place(candidate.T_scene_model);
      one["log_odds"] = candidate.log_odds;
      one["rays"] = candidate.rays;
      one["differs"] = std::move(differs);
    }
    out.append(std::move(one));
  }
  return out;
}

py::array_t<double> covariance_of(const DetectionHandle& self) {
  py::array_t<double> out({6, 6});
  auto numbers = out.mutable_unchecked<2>();
  for (py::ssize_t row = 0; row < 6; ++row) {
    for (py::ssize_t column = 0; column < 6; ++column)
      numbers(row, column) = static_cast<double>(self.one->covariance(row, column));
  }
  return out;
}

template <class Kind>
py::dict score_parts(const Part<Kind>& self) {
  py::dict out;
  for (std::size_t k = 0; k < self.one->parts.size(); ++k)
    out[py::str(std::string(kernels::kScoreParts[k].name))] = self.one->parts[k];
  return out;
}

py::object turns_of(const DetectionHandle& self) {
  if (!self.one->turns) return py::none();
  const TurnExtent& turns = *self.one->turns;
  py::dict out;
  out["axis"] = vector_of(Eigen::Vector3f(turns.axis.direction).cast<double>());
  out["point"] = vector_of(Eigen::Vector3f(turns.axis.point).cast<double>());
  out["low"] = turns.low;
  out["high"] = turns.high;
  return out;
}

/// The meshes of the detected models only: a library may have thousands of models.
Result<std::vector<EvaluationMesh>> found_meshes(const Recognized& self) {
  const Library& library = self.recognizer->library();
  std::vector<EvaluationMesh> meshes;
  for (std::uint32_t m = 0; m < library.models.size(); ++m) {
    const ModelInfo& model = library.models[m];
    const bool found = std::ranges::any_of(
        self.result.detections, [&](const Detection& one) { return one.model == model.name; });
    if (!found) continue;
    TRIVET_TRY_ASSIGN(const ModelSurface* const surface, library.surface(m));
    meshes.push_back(
        {model.name, surface->vertices, surface->triangles, model.diameter, model.symmetry});
  }
  return meshes;
}

struct Drawing {
  Picture picture;
  std::vector<std::string> colors;  ///< colors of the detections, as CSS
};

Result<Drawing> draw(const Recognized& self) {
  const Result<std::vector<EvaluationMesh>> meshes = found_meshes(self);
  if (!meshes) return meshes.error();
  float largest = 0;
  for (const ModelInfo& model : self.recognizer->library().models)
    largest = std::max(largest, model.diameter);
  Result<SceneDrawing> drawing =
      SceneDrawing::prepare(*self.scene.cloud, self.scene.input, largest);
  if (!drawing) return drawing.error();
  std::vector<Overlay> overlays;
  Drawing out;
  for (const Detection& detection : self.result.detections) {
    const EvaluationMesh* const mesh = find_mesh(*meshes, detection.model);
    const Color color = apps::model_color(*meshes, *mesh);
    FilePose pose = in_file_frame(detection.T_scene_model, self.result.offset);
    pose.translation() *= self.scene.input.scale;
    overlays.push_back({mesh, pose, color, color});
    out.colors.push_back(apps::css(color));
  }
  Result<ScenePictures> pictures = drawing->draw(overlays);
  if (!pictures) return pictures.error();
  out.picture = std::move(pictures->overlaid);
  return out;
}

py::tuple picture_of(const Recognized& self) {
  const Drawing drawing = unwrap([&] {
    const py::gil_scoped_release released;
    return draw(self);
  }());
  const Picture& picture = drawing.picture;
  py::array_t<std::uint8_t> pixels({static_cast<py::ssize_t>(picture.height),
                                    static_cast<py::ssize_t>(picture.width), py::ssize_t{3}});
  std::ranges::copy(picture.rgb, pixels.mutable_data());
  const std::vector<std::byte> png = unwrap(encode_png(picture));
  return py::make_tuple(pixels, py::bytes(reinterpret_cast<const char*>(png.data()), png.size()),
                        drawing.colors);
}

void add_detections(py::module_& module) {
  using Handle = DetectionHandle;
  const auto has = [](auto member) {
    return [member](const Handle& self) { return self.one->*member; };
  };
  py::class_<Handle>(module, "Detection")
      .def_property_readonly("model", has(&Detection::model))
      .def_property_readonly("score", has(&Detection::score))
      .def_property_readonly(
          "pose", [](const Handle& self) { return self.all->place(self.one->T_scene_model); })
      .def_property_readonly("visible_fraction", has(&Detection::visible_fraction))
      .def_property_readonly("hidden_fraction", has(&Detection::hidden_fraction))
      .def_property_readonly("outside_fraction", has(&Detection::outside_fraction))
      .def_property_readonly("violation", has(&Detection::violation))
      .def_property_readonly("contour", has(&Detection::contour))
      .def_property_readonly("rmse", has(&Detection::rmse))
      .def_property_readonly("deviation", has(&Detection::deviation))
      .def_property_readonly("parts", &score_parts<Detection>)
      .def_property_readonly("alternatives", &alternatives_of)
      .def_property_readonly("identity", [](const Handle& self) { return self.one->identity(); })
      .def_property_readonly("candidates", &candidates_of)
      .def_property_readonly(
          "source", [](const Handle& self) { return std::string(name_of(self.one->source)); })
      .def_property_readonly("pose_share", has(&Detection::pose_share))
      .def_property_readonly("pose_score",
                             [](const Handle& self) { return self.one->pose_score(); })
      .def_property_readonly("covariance", &covariance_of)
      .def_property_readonly("turns", &turns_of);
  py::class_<RejectedHandle>(module, "RejectedPose")
      .def_property_readonly("model", [](const RejectedHandle& self) { return self.one->model; })
      .def_property_readonly("score", [](const RejectedHandle& self) { return self.one->score; })
      .def_property_readonly(
          "pose",
          [](const RejectedHandle& self) { return self.all->place(self.one->T_scene_model); })
      .def_property_readonly("parts", &score_parts<RejectedPose>)
      .def_property_readonly(
          "reason",
          [](const RejectedHandle& self) { return std::string(apps::name_of(self.one->reason)); })
      .def_property_readonly("explained_by",
                             [](const RejectedHandle& self) { return self.one->explained_by; });
}

}  // namespace

RecognizeOptions recognize_options(const std::string& preset, const py::dict& keywords) {
  const auto found = recognize_presets().find(preset);
  if (found == recognize_presets().end()) {
    raise({ErrorCode::usage,
           fmt::format("preset: expected fast, balanced or accurate, found '{}'", preset)});
  }
  RecognizeOptions options = found->second;
  py::dict rest;
  for (const auto& [key, value] : keywords) {
    if (py::cast<std::string>(key) != "expected") {
      rest[key] = value;
      continue;
    }
    for (const py::handle one : value) {
      const auto pair = one.cast<py::tuple>();
      options.expected.push_back({pair[0].cast<std::string>(), pose_of(pair[1], "expected")});
    }
  }
  set_options(rest, options);
  return options;
}

void add_recognize(py::module_& module) {
  add_detections(module);
  py::class_<Stopper>(module, "Stopper")
      .def(py::init<>())
      .def("stop", [](Stopper& self) { self.source.request_stop(); })
      .def_property_readonly("stopped",
                             [](const Stopper& self) { return self.source.stop_requested(); });
  py::class_<Recognized, std::shared_ptr<Recognized>>(module, "_Recognized")
      .def_property_readonly("detections",
                             [](const std::shared_ptr<Recognized>& self) {
                               return parts_of<Detection>(self, self->result.detections);
                             })
      .def_property_readonly("rejected",
                             [](const std::shared_ptr<Recognized>& self) {
                               return parts_of<RejectedPose>(self, self->result.rejected);
                             })
      .def_property_readonly(
          "name", [](const Recognized& self) { return path_text(self.scene.input.file.string()); })
      .def_property_readonly("seconds",
                             [](const Recognized& self) { return self.result.stats.total_seconds; })
      .def("json", &json_of)
      .def("draw", &picture_of);
  module.def("_recognize", &recognize_scene, py::arg("library"), py::arg("scene"),
             py::arg("preset"), py::arg("stopper").none(true), py::arg("options"));
  module.def("_recognize_options", &describe_options<RecognizeOptions>);
}

}  // namespace trivet::python
