#include "storage/datasets/write_bop.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/files/file.hpp"
#include "storage/files/json_text.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json row_json(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

/// The values row by row.
template <int rows, int columns>
ordered_json numbers_json(const Eigen::Matrix<float, rows, columns>& m) {
  ordered_json numbers = ordered_json::array();
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) numbers.push_back(m(row, column));
  }
  return numbers;
}

ordered_json object_json(const BopObject& object) {
  ordered_json out{{"diameter", object.diameter_mm}};
  const std::string_view axes = "xyz";
  for (int i = 0; i < 3; ++i)
    out[fmt::format("min_{}", axes[static_cast<std::size_t>(i)])] = object.min_mm[i];
  for (int i = 0; i < 3; ++i)
    out[fmt::format("size_{}", axes[static_cast<std::size_t>(i)])] = object.size_mm[i];
  for (const Pose& pose : object.symmetry.poses)
    out["symmetries_discrete"].push_back(numbers_json<4, 4>(pose.matrix()));
  if (const auto& axis = object.symmetry.axis) {
    out["symmetries_continuous"].push_back(
        {{"axis", row_json(axis->direction)}, {"offset", row_json(axis->point)}});
  }
  return out;
}

ordered_json pose_json(const BopInstance& instance) {
  return {{"cam_R_m2c", numbers_json<3, 3>(instance.T_camera_model.linear())},
          {"cam_t_m2c", row_json(instance.T_camera_model.translation())},
          {"obj_id", instance.object_id}};
}

ordered_json info_json(const BopInstance& instance) {
  return {{"bbox_obj", instance.bbox_obj},
          {"bbox_visib", instance.bbox_visib},
          {"px_count_all", instance.px_count_all},
          {"px_count_valid", instance.px_count_valid},
          {"px_count_visib", instance.px_count_visib},
          {"visib_fract", instance.visib_fract}};
}

ordered_json instances_json(const BopImage& image, ordered_json (*part)(const BopInstance&)) {
  ordered_json out = ordered_json::array();
  for (const BopInstance& instance : image.instances) out.push_back(part(instance));
  return out;
}

ordered_json image_camera_json(const BopImage& image) {
  const Camera& camera = image.camera;
  return {{"cam_K", {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1}},
          {"depth_scale", camera.depth_scale}};
}

Result<void> publish_text(const fs::path& file, std::string_view text) {
  return publish_file(file, std::as_bytes(std::span(text)));
}

/// An object with numbers as names and each member on a separate line, in the format of the
/// benchmark's tools.
template <class Items, class Json>
Result<void> publish_by_id(const fs::path& file, const Items& items, Json&& json) {
  std::map<int, std::string> lines;
  for (const auto& item : items) lines.emplace(item.id, json_text(json(item)));
  std::string text = "{";
  for (const auto& [id, line] : lines)
    text += fmt::format("{}\n  \"{}\": {}", text == "{" ? "" : ",", id, line);
  return publish_text(file, text + "\n}\n");
}

Result<void> publish_list(const fs::path& file, const std::vector<ordered_json>& items) {
  std::string text = "[";
  for (const ordered_json& item : items)
    text += fmt::format("{}\n  {}", text == "[" ? "" : ",", json_text(item));
  return publish_text(file, text + "\n]\n");
}

/// Number of instances of each object that are visible enough to be targets.
std::map<int, int> targets_of(const BopImage& image) {
  std::map<int, int> num_instances;
  for (const BopInstance& instance : image.instances) {
    if (instance.visib_fract >= kBopMinVisibleFraction) ++num_instances[instance.object_id];
  }
  return num_instances;
}

}  // namespace

Result<void> write_bop_models_info(const fs::path& file, std::span<const BopObject> objects) {
  return publish_by_id(file, objects, object_json);
}

Result<void> write_bop_camera(const fs::path& file, const Camera& camera, std::uint32_t width,
                              std::uint32_t height) {
  const ordered_json document{
      {"cx", camera.cx}, {"cy", camera.cy}, {"depth_scale", camera.depth_scale},
      {"fx", camera.fx}, {"fy", camera.fy}, {"height", height},
      {"width", width}};
  return publish_text(file, json_text(document, 2) + "\n");
}

Result<void> write_bop_scene(const fs::path& folder, std::span<const BopImage> images) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return Error{ErrorCode::cannot_create,
                 fmt::format("{}: cannot be created: {}", folder.string(), error.message())};
  }
  Result<void> done = publish_by_id(folder / "scene_camera.json", images, image_camera_json);
  if (!done) return done;
  done = publish_by_id(folder / "scene_gt.json", images,
                       [](const BopImage& image) { return instances_json(image, pose_json); });
  if (!done) return done;
  return publish_by_id(folder / "scene_gt_info.json", images,
                       [](const BopImage& image) { return instances_json(image, info_json); });
}

Result<void> write_bop_targets(const fs::path& folder, std::span<const BopScene> scenes) {
  std::vector<ordered_json> instances, images;
  for (const BopScene& scene : scenes) {
    for (const BopImage& image : scene.images) {
      images.push_back({{"im_id", image.id}, {"scene_id", scene.id}});
      for (const auto& [object_id, num_instances] : targets_of(image)) {
        instances.push_back({{"im_id", image.id},
                             {"inst_count", num_instances},
                             {"obj_id", object_id},
                             {"scene_id", scene.id}});
      }
    }
  }
  const Result<void> done = publish_list(folder / "test_targets_bop19.json", instances);
  if (!done) return done;
  return publish_list(folder / "test_targets_bop24.json", images);
}

}  // namespace trivet
