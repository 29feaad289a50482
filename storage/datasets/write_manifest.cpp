#include <nlohmann/json.hpp>

#include "storage/datasets/manifest.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_text.hpp"
#include "storage/formats/camera_json.hpp"

namespace trivet {
namespace {

using nlohmann::ordered_json;

template <class T>
ordered_json vector_json(const T& v) {
  return {v.x(), v.y(), v.z()};
}

ordered_json pose_json(const FilePose& pose) {
  const Eigen::Matrix4d m = pose.matrix();
  ordered_json rows = ordered_json::array();
  for (Eigen::Index row = 0; row < 4; ++row)
    rows.push_back({m(row, 0), m(row, 1), m(row, 2), m(row, 3)});
  return rows;
}

ordered_json model_json(const ManifestModel& model, const std::filesystem::path& folder) {
  ordered_json out{{"file", model.file.lexically_proximate(folder).generic_string()},
                   {"scale", model.scale}};
  if (!model.symmetry) return out;
  out["symmetries"] = ordered_json::array();
  for (const Pose& pose : model.symmetry->poses)
    out["symmetries"].push_back(pose_json(pose.cast<double>()));
  if (model.symmetry->axis) {
    out["symmetry_axis"] = {{"axis", vector_json(model.symmetry->axis->direction)},
                            {"offset", vector_json(model.symmetry->axis->point)}};
  }
  return out;
}

ordered_json scene_json(const ManifestScene& scene, const std::filesystem::path& folder) {
  ordered_json out{{"file", scene.file.lexically_proximate(folder).generic_string()}};
  if (scene.camera) out["camera"] = camera_json(*scene.camera);
  if (scene.viewpoint) out["viewpoint"] = vector_json(*scene.viewpoint);
  out["truth"] = ordered_json::array();
  for (const TruthInstance& truth : scene.truth) {
    ordered_json entry{{"model", truth.model}, {"T_scene_model", pose_json(truth.file_pose())}};
    if (truth.visible_fraction) entry["visible_fraction"] = *truth.visible_fraction;
    if (truth.occlusion) entry["occlusion"] = *truth.occlusion;
    if (truth.clutter) entry["clutter"] = *truth.clutter;
    entry["ignore"] = truth.ignore;
    out["truth"].push_back(std::move(entry));
  }
  return out;
}

}  // namespace

Result<void> write_manifest(const std::filesystem::path& file, const Manifest& manifest) {
  const std::filesystem::path folder = file.parent_path();
  ordered_json models = ordered_json::object(), scenes = ordered_json::array();
  for (const ManifestModel& model : manifest.models) models[model.name] = model_json(model, folder);
  for (const ManifestScene& scene : manifest.scenes) scenes.push_back(scene_json(scene, folder));
  ordered_json document{{"unit", unit_name(manifest.unit)}, {"models", std::move(models)}};
  if (!manifest.models_scored.empty()) document["models_scored"] = manifest.models_scored;
  document["scenes"] = std::move(scenes);
  const std::string text = json_text(document, 1) + "\n";
  return publish_file(file, std::as_bytes(std::span(text)));
}

}  // namespace trivet
