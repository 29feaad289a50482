#include "storage/datasets/read_bop.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "storage/files/json_file.hpp"
#include "storage/files/numbers.hpp"
#include "storage/formats/camera_json.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

/// Folders of training meshes in order of preference.
constexpr std::array kModelFolders{"models", "models_cad", "models_eval"};

std::optional<fs::path> find_models(const fs::path& root) {
  for (const char* name : kModelFolders) {
    if (is_there(root / name / "models_info.json")) return root / name;
  }
  return {};
}

/// Subfolders by name; none if the folder cannot be read.
std::vector<std::string> list_folders(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_directory(ignored)) names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The ids of a split's scenes.
std::set<int> list_scenes(const fs::path& split) {
  std::set<int> ids;
  for (const std::string& name : list_folders(split)) {
    const auto id = parse_integer(name);
    if (id && *id >= 0 && *id <= kMaxBopId && name == fmt::format("{:06}", *id))
      ids.insert(static_cast<int>(*id));
  }
  return ids;
}

/// A data set and its requested split.
struct Place {
  fs::path root, models;
  fs::path split;      ///< empty: to be chosen
  std::string camera;  ///< empty: the one with depth images
};

std::optional<Place> find_folder(const fs::path& folder) {
  if (const auto models = find_models(folder)) return Place{folder, *models, {}, {}};
  const fs::path root = (folder / "..").lexically_normal();
  const auto models = find_models(root);
  if (!models || list_scenes(folder).empty()) return {};
  return Place{root, *models, folder, {}};
}

/// FOLDER or FOLDER:CAMERA
std::optional<Place> find_place(const fs::path& argument) {
  const std::string text = argument.string();
  const std::size_t colon = text.rfind(':');
  if (is_there(argument) || colon == std::string::npos) return find_folder(argument);
  std::optional<Place> place = find_folder(text.substr(0, colon));
  if (place) place->camera = text.substr(colon + 1);
  return place;
}

Result<Place> place_of(const fs::path& folder) {
  if (const auto place = find_place(folder)) return *place;
  return Error{ErrorCode::missing_input,
               fmt::format("{}: expected a BOP data set with models/models_info.json, or one of "
                           "its splits, found neither",
                           folder.string())};
}

/// The folder's own name, also where it is called "." or ends in a slash.
fs::path name_of(const fs::path& folder) {
  return fs::absolute(folder / "").lexically_normal().parent_path().filename();
}

bool is_test(std::string_view split_name) { return split_name.starts_with("test"); }

/// The only split with test images.
Result<fs::path> choose_split(const fs::path& root) {
  std::vector<std::string> splits = list_folders(root);
  std::erase_if(splits, [&](const std::string& name) {
    return !is_test(name) || list_scenes(root / name).empty();
  });
  if (splits.size() == 1) return root / splits[0];
  if (splits.empty()) {
    return Error{ErrorCode::missing_input,
                 fmt::format("{}: expected a folder of test images such as test/000001, found "
                             "none; name the folder of another split",
                             root.string())};
  }
  return Error{ErrorCode::usage,
               fmt::format("{}: expected one folder of test images, found {}; name one of them",
                           root.string(), fmt::join(splits, ", "))};
}

/// An id used as a key, in its canonical form only.
int parse_id(const std::string& key, const JsonNode& node) {
  const auto id = parse_integer(key);
  if (!id || *id < 0 || *id > kMaxBopId || key != std::to_string(*id))
    node.refuse("expected a number as the name of this entry");
  return static_cast<int>(*id);
}

BopObject parse_object(int id, const JsonNode& node) {
  const auto length = [&](std::string_view key) {
    return node.has(key) ? node.at(key).coordinate() : 0.0;
  };
  BopObject object{id,
                   length("diameter"),
                   {length("min_x"), length("min_y"), length("min_z")},
                   {length("size_x"), length("size_y"), length("size_z")},
                   {{}, {}, true}};
  if (node.has("symmetries_discrete"))
    object.symmetry.poses = node.at("symmetries_discrete").symmetry_poses();
  if (!node.has("symmetries_continuous")) return object;
  const JsonNode axes = node.at("symmetries_continuous");
  const auto listed = axes.elements();
  if (listed.size() > 1) {
    axes.refuse(fmt::format("expected at most one axis instead of {}", listed.size()));
  }
  if (!listed.empty()) object.symmetry.axis = listed[0].symmetry_axis();
  return object;
}

/// Number of instances of each object to be found in each image of a scene.
using ImageTargets = std::map<int, std::map<int, int>>;
using Targets = std::map<int, ImageTargets>;  ///< by scene

Result<void> add_targets(const fs::path& file, bool with_counts, Targets& targets) {
  return with_json(file, [&](const JsonNode& root) {
    for (const JsonNode& node : root.elements()) {
      auto& image = targets[node.at("scene_id").integer(0, kMaxBopId)]
                           [node.at("im_id").integer(0, kMaxBopId)];
      if (!with_counts || !node.has("obj_id")) continue;
      const int count = node.at("inst_count").integer(1, 10'000);
      if (!image.emplace(node.at("obj_id").integer(0, kMaxBopId), count).second)
        node.refuse("expected each object of an image once");
    }
  });
}

/// Empty without a file.
Result<std::optional<Targets>> read_targets(const fs::path& root) {
  std::optional<Targets> targets;
  for (const char* name : {"test_targets_bop19.json", "test_targets_bop24.json"}) {
    if (!is_there(root / name)) continue;
    const bool first = !targets;
    if (first) targets.emplace();
    TRIVET_TRY(add_targets(root / name, first, *targets));
  }
  return targets;
}

std::string comma_list(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The names of a scene's cameras, if its files contain them: scene_camera_NAME.json.
std::vector<std::string> list_cameras(const fs::path& folder) {
  constexpr std::string_view kBegin = "scene_camera_";
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path file = entry->path().filename();
    const std::string stem = file.stem().string();
    if (file.extension() == ".json" && stem.starts_with(kBegin) && stem.size() > kBegin.size())
      names.push_back(stem.substr(kBegin.size()));
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Paths of the files of one camera of a scene.
struct SceneFiles {
  fs::path folder;
  std::string suffix;  ///< "_" and the camera's name, or nothing

  fs::path json(std::string_view what) const {
    return folder / fmt::format("{}{}.json", what, suffix);
  }
  fs::path depth(int image_id) const {
    return folder / ("depth" + suffix) / bop_depth_file(folder, image_id).filename();
  }
};

/// Reads the scenes of a split into a manifest that already has its models.
class SceneReader {
 public:
  SceneReader(const fs::path& split, const std::string& camera, Manifest& manifest)
      : split_(split), camera_(camera), manifest_(manifest) {
    for (const ManifestModel& model : manifest.models) names_[model.object_id] = model.name;
  }

  /// images   images to be read, all if absent
  Result<void> read(int scene_id, const ImageTargets* images) {
    const fs::path folder = bop_scene_folder(split_, scene_id);
    TRIVET_TRY_ASSIGN(const std::string camera, find_camera(folder));
    const SceneFiles files{folder, camera};
    std::map<int, ManifestScene> scenes;
    TRIVET_TRY(read_cameras(files, images, scenes));
    TRIVET_TRY(read_truth(files, scenes));
    for (auto& [image_id, scene] : scenes) {
      scene.scene_id = scene_id;
      scene.image_id = image_id;
      TRIVET_TRY(find_depth(files, scene));
      if (images) {
        for (const auto& [object_id, count] : images->at(image_id)) {
          const auto name = names_.find(object_id);
          if (name == names_.end()) return unknown_target(object_id);
          scene.targets.push_back({name->second, static_cast<std::uint32_t>(count)});
        }
      }
      manifest_.scenes.push_back(std::move(scene));
    }
    return {};
  }

 private:
  /// The suffix after "scene_camera", "depth" ... in the names of a scene's files: empty, or "_"
  /// and the camera's name if there are several: the requested one, or the one with depth images.
  Result<std::string> find_camera(const fs::path& folder) const {
    const std::vector<std::string> cameras = list_cameras(folder);
    if (!camera_.empty()) {
      if (std::ranges::find(cameras, camera_) != cameras.end()) return "_" + camera_;
      return Error{ErrorCode::missing_input,
                   fmt::format("{}: expected the camera {}, found {}", folder.string(), camera_,
                               cameras.empty() ? "none that is named" : comma_list(cameras))};
    }
    if (cameras.empty() || is_there(folder / "scene_camera.json")) return std::string();
    std::vector<std::string> with_depth = cameras;
    std::erase_if(with_depth,
                  [&](const std::string& name) { return !is_there(folder / ("depth_" + name)); });
    if (with_depth.size() == 1) return "_" + with_depth[0];
    if (with_depth.empty()) {
      return Error{ErrorCode::missing_input,
                   fmt::format("{}: expected a camera with depth images, found {}, and no folder "
                               "such as depth_{}",
                               folder.string(), comma_list(cameras), cameras[0])};
    }
    return Error{
        ErrorCode::usage,
        fmt::format("{}: expected one camera with depth images, found {}; name one as "
                    "{}:{}",
                    folder.string(), comma_list(with_depth), split_.string(), with_depth[0])};
  }

  static Result<void> read_cameras(const SceneFiles& files, const ImageTargets* images,
                                   std::map<int, ManifestScene>& scenes) {
    const fs::path file = files.json("scene_camera");
    return with_json(file, [&](const JsonNode& root) {
      for (const auto& [key, node] : root.members()) {
        const int image_id = parse_id(key, node);
        if (images && !images->contains(image_id)) continue;
        scenes[image_id].camera = parse_camera(node);
      }
      if (!images) return;
      for (const auto& [image_id, targets] : *images) {
        if (!scenes.contains(image_id))
          root.refuse(fmt::format("expected image {}, which is a target", image_id));
      }
    });
  }

  using Truth = std::vector<TruthInstance>;

  Result<void> read_truth(const SceneFiles& files, std::map<int, ManifestScene>& scenes) const {
    const fs::path poses = files.json("scene_gt"), info = files.json("scene_gt_info");
    if (!is_there(poses)) return {};
    const auto done = for_images(poses, scenes, [&](const JsonNode& node, Truth& truth) {
      for (const JsonNode& instance : node.elements()) truth.push_back(parse_truth(instance));
    });
    return done && is_there(info) ? for_images(info, scenes, add_visibility) : done;
  }

  /// Call parse(entry, truth) for each requested image.
  template <class Parse>
  static Result<void> for_images(const fs::path& file, std::map<int, ManifestScene>& scenes,
                                 Parse&& parse) {
    return with_json(file, [&](const JsonNode& root) {
      for (const auto& [key, node] : root.members()) {
        const auto scene = scenes.find(parse_id(key, node));
        if (scene != scenes.end()) parse(node, scene->second.truth);
      }
    });
  }

  static void add_visibility(const JsonNode& node, Truth& truth) {
    const auto instances = node.elements();
    if (instances.size() != truth.size()) {
      node.refuse(fmt::format("expected {} instances as in scene_gt.json instead of {}",
                              truth.size(), instances.size()));
    }
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const JsonNode fraction = instances[i].at("visib_fract");
      if (!(fraction.number() >= 0 && fraction.number() <= 1))
        fraction.refuse("expected a number from 0 to 1");
      truth[i].visible_fraction = fraction.number();
      truth[i].ignore = fraction.number() < kBopMinVisibleFraction;
    }
  }

  TruthInstance parse_truth(const JsonNode& node) const {
    const auto name = names_.find(node.at("obj_id").integer(0, kMaxBopId));
    if (name == names_.end()) node.at("obj_id").refuse("expected an object of models_info.json");
    TruthInstance truth{name->second, Pose::Identity(), {}, false};
    truth.T_scene_model.linear() = node.at("cam_R_m2c").rotation();
    truth.T_scene_model.translation() = node.at("cam_t_m2c").vector3().cast<float>();
    return truth;
  }

  Result<void> find_depth(const SceneFiles& files, ManifestScene& scene) const {
    const fs::path file = files.depth(scene.image_id);
    for (const char* extension : {".png", ".tif", ".tiff"}) {
      scene.file = fs::path(file).replace_extension(extension);
      scene.name = (name_of(split_) / scene.file.lexically_relative(split_)).generic_string();
      if (is_there(scene.file)) return {};
    }
    return Error{ErrorCode::missing_input,
                 fmt::format("{}: expected the depth of an image of {}, found no such file",
                             file.string(), files.json("scene_camera").filename().string())};
  }

  Error unknown_target(int object_id) const {
    return {ErrorCode::bad_data,
            fmt::format("{}: expected targets among the objects of models_info.json, found object "
                        "{}",
                        split_.string(), object_id)};
  }

  const fs::path& split_;
  const std::string& camera_;
  Manifest& manifest_;
  std::map<int, std::string> names_;  ///< model names by object id
};

Result<Manifest> read_models(const Place& place) {
  TRIVET_TRY_ASSIGN(const auto objects, read_bop_models_info(place.models / "models_info.json"));
  Manifest manifest;
  manifest.unit = LengthUnit::millimeter;
  for (const BopObject& object : objects) {
    ManifestModel model;
    model.name = bop_model_name(object.id);
    model.file = place.models / (model.name + ".ply");
    model.object_id = object.id;
    if (object.diameter_mm > 0) model.diameter = object.diameter_mm;
    if (!object.symmetry.trivial()) model.symmetry = object.symmetry;
    const fs::path eval_file = place.root / "models_eval" / model.file.filename();
    if (is_there(eval_file)) model.eval_file = eval_file;
    manifest.models.push_back(std::move(model));
  }
  return manifest;
}

}  // namespace

bool is_bop_folder(const fs::path& folder) { return find_place(folder).has_value(); }

Result<Manifest> read_bop_models(const fs::path& folder) {
  TRIVET_TRY_ASSIGN(const Place place, place_of(folder));
  return read_models(place);
}

Result<Manifest> read_bop(const fs::path& folder) {
  TRIVET_TRY_ASSIGN(const Place place, place_of(folder));
  Result<Manifest> manifest = read_models(place);
  if (!manifest) return manifest;
  TRIVET_TRY_ASSIGN(const fs::path split,
                    place.split.empty() ? choose_split(place.root) : place.split);

  Result<std::optional<Targets>> targets = std::optional<Targets>();
  if (is_test(name_of(split).string())) targets = read_targets(place.root);
  if (!targets) return targets.error();
  SceneReader reader(split, place.camera, *manifest);
  if (*targets) {
    for (const auto& [scene_id, images] : **targets) TRIVET_TRY(reader.read(scene_id, &images));
  } else {
    for (const int scene_id : list_scenes(split)) TRIVET_TRY(reader.read(scene_id, nullptr));
  }
  return manifest;
}

Result<std::vector<BopObject>> read_bop_models_info(const fs::path& file) {
  std::map<int, BopObject> objects;
  TRIVET_TRY(with_json(file, [&](const JsonNode& root) {
    for (const auto& [key, node] : root.members()) {
      const int id = parse_id(key, node);
      objects.emplace(id, parse_object(id, node));
    }
  }));
  std::vector<BopObject> sorted;
  for (auto& [id, object] : objects) sorted.push_back(std::move(object));
  return sorted;
}

}  // namespace trivet
