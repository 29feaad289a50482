#include "storage/datasets/manifest.hpp"

#include <fmt/format.h>

#include <set>

#include "storage/datasets/parse_symmetry.hpp"
#include "storage/datasets/parse_truth.hpp"
#include "storage/files/json_file.hpp"
#include "storage/formats/camera_json.hpp"
#include "storage/library/model_name.hpp"

namespace trivet {
namespace {

LengthUnit parse_unit(const JsonNode& node) {
  const std::string unit = node.string();
  if (unit != "m" && unit != "mm") node.refuse("expected the unit \"m\" or \"mm\"");
  return unit == "m" ? LengthUnit::meter : LengthUnit::millimeter;
}

double positive(const JsonNode& node) {
  const double value = node.number();
  if (!(value > 0)) node.refuse("expected a number above zero");
  return value;
}

ManifestModel parse_model(const std::string& name, const JsonNode& node,
                          const std::filesystem::path& folder) {
  if (!is_model_name(name)) node.refuse(fmt::format("expected a name of {}", kModelNameRule));
  node.only({"file", "scale", "symmetries", "symmetry_axis"});
  ManifestModel model;
  model.name = name;
  model.file = folder / node.at("file").string();
  if (node.has("scale")) model.scale = positive(node.at("scale"));
  model.symmetry = parse_symmetry(node);
  return model;
}

ManifestScene parse_scene(const JsonNode& node, const std::filesystem::path& folder) {
  node.only({"file", "camera", "viewpoint", "truth"});
  ManifestScene scene;
  scene.name = node.at("file").string();
  scene.file = folder / scene.name;
  if (node.has("camera")) scene.camera = parse_camera(node.at("camera"));
  if (node.has("viewpoint")) scene.viewpoint = node.at("viewpoint").vector3();
  scene.closed_surface = !scene.camera && !scene.viewpoint;
  if (node.has("truth")) {
    for (const JsonNode& truth : node.at("truth").elements())
      scene.truth.push_back(parse_truth(truth));
  }
  return scene;
}

/// JSON objects have no order; the order in the file is recorded during parsing.
class ModelOrder {
 public:
  void on_key(int depth, const std::string& key) {
    if (depth == 1) inside_ = key == "models";
    if (depth != 2 || !inside_) return;
    if (!visited_.insert(key).second)
      throw JsonFault{fmt::format("models: {} stands there twice", key)};
    names_.push_back(key);
  }
  const std::vector<std::string>& names() const noexcept { return names_; }

 private:
  bool inside_ = false;
  std::set<std::string> visited_;
  std::vector<std::string> names_;
};

}  // namespace

std::optional<Symmetry> parse_symmetry(const JsonNode& model) {
  Symmetry symmetry{{}, {}, true};
  bool declared = false;
  if (model.has("symmetries")) {
    declared = !model.at("symmetries").elements().empty();
    symmetry.poses = model.at("symmetries").symmetry_poses();
  }
  if (model.has("symmetry_axis")) {
    declared = true;
    symmetry.axis = model.at("symmetry_axis").only({"axis", "offset"}).symmetry_axis();
  }
  return declared ? std::optional(symmetry) : std::nullopt;
}

TruthInstance parse_truth(const JsonNode& node) {
  // Additional notes by users, such as how the file was made, are allowed.
  node.without_misspelled(
      {"model", "T_scene_model", "occlusion", "visible_fraction", "clutter", "ignore"});
  const FilePose pose = node.at("T_scene_model").file_pose();
  TruthInstance truth{node.at("model").string(), pose.cast<float>(), {}, false};
  truth.rounded_off = pose.translation() - truth.T_scene_model.translation().cast<double>();
  if (node.has("occlusion")) truth.occlusion = node.at("occlusion").number();
  if (node.has("visible_fraction")) truth.visible_fraction = node.at("visible_fraction").number();
  if (node.has("clutter")) truth.clutter = node.at("clutter").number();
  if (node.has("ignore")) truth.ignore = node.at("ignore").boolean();
  return truth;
}

Result<Manifest> read_manifest(const std::filesystem::path& file) {
  const auto folder = file.parent_path();
  Manifest manifest;
  ModelOrder order;
  const auto walk = [&](const JsonNode& root) {
    root.only({"unit", "models", "models_scored", "scenes"});
    manifest.unit = parse_unit(root.at("unit"));
    if (root.has("models")) {
      const JsonNode models = root.at("models").object();
      for (const std::string& name : order.names()) {
        manifest.models.push_back(parse_model(name, models.at(name), folder));
      }
    }
    if (root.has("models_scored")) {
      for (const JsonNode& name : root.at("models_scored").elements()) {
        manifest.models_scored.push_back(name.string());
      }
    }
    if (root.has("scenes")) {
      for (const JsonNode& scene : root.at("scenes").elements()) {
        manifest.scenes.push_back(parse_scene(scene, folder));
      }
    }
  };
  TRIVET_TRY(
      with_json(file, walk, [&](int depth, const std::string& key) { order.on_key(depth, key); }));
  return manifest;
}

}  // namespace trivet
