#include "apps/inputs/inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <span>

#include "engine/evaluation/manifest_inputs.hpp"
#include "storage/datasets/read_bop.hpp"
#include "storage/files/file.hpp"
#include "storage/files/gunzip.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/read_cloud.hpp"
#include "storage/library/model_name.hpp"

namespace trivet::apps {
namespace {

namespace fs = std::filesystem;

bool has_extension(const fs::path& file, std::string_view extension) {
  return formats::lower_case(file.extension().string()) == extension;
}

/// Describes the contents of a folder without geometry, and suggests what to give instead.
std::string describe_folder(const fs::path& folder) {
  fs::path listing;
  std::size_t num_images = 0;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    num_images += is_depth_file(entry.path()) ? 1 : 0;
    const bool first = listing.empty() || entry.path() < listing;
    if (has_extension(entry.path(), ".json") && first && read_manifest(entry.path()))
      listing = entry.path();
  }
  if (!listing.empty())
    return fmt::format("the manifest {}; give that file", listing.filename().string());
  if (num_images > 0) {
    return fmt::format("{} images; as scenes, depth images need a manifest or --camera",
                       num_images);
  }
  return "none";
}

/// Whether a file accompanies models and scans but is none: pictures, textures, materials, lists,
/// notes.
bool is_companion(const fs::path& file) {
  constexpr std::array<std::string_view, 14> kCompanions{".json", ".png",  ".jpg", ".jpeg", ".bmp",
                                                         ".tif",  ".tiff", ".mtl", ".bin",  ".txt",
                                                         ".csv",  ".md",   ".pdf", ".toml"};
  return std::ranges::any_of(
      kCompanions, [&](std::string_view companion) { return has_extension(file, companion); });
}

/// The files of a folder that `readable` accepts, by name. Names that begin with a dot are hidden,
/// such as macOS's "._part.stl" beside part.stl.
/// Errors: missing_input, bad_data (none).
///
/// left_out  receives the other files and the folders, whose names then end in a slash
template <class Readable>
Result<std::vector<fs::path>> list_folder(const fs::path& folder, Readable&& readable,
                                          std::vector<std::string>& left_out) {
  std::vector<fs::path> files;
  std::vector<std::string> others;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    std::error_code ignored;
    if (path.filename().string().starts_with('.')) continue;
    if (entry.is_directory(ignored)) {
      others.push_back(path.string() + '/');
    } else if (entry.is_regular_file(ignored) && readable(path)) {
      files.push_back(path);
    } else if (!is_companion(path)) {
      others.push_back(path.string());
    }
  }
  std::sort(others.begin(), others.end());
  left_out.insert(left_out.end(), others.begin(), others.end());
  if (error)
    return Error{ErrorCode::missing_input, fmt::format("{}: {}", folder.string(), error.message())};
  if (files.empty()) {
    return Error{
        ErrorCode::missing_input,
        fmt::format("{}: expected files that end with one of .{}, found {}", folder.string(),
                    fmt::join(cloud_extensions(), " ."), describe_folder(folder))};
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Declares the symmetries of BOP models (obj_000001.ply ...) from models_info.json in their
/// folder, in the models' unit.
Result<void> declare_bop_symmetries(const fs::path& folder, std::span<ModelSource> sources) {
  const fs::path info = folder / "models_info.json";
  if (!fs::exists(info)) return {};
  const Result<std::vector<BopObject>> objects = read_bop_models_info(info);
  if (!objects) return objects.error();
  for (const BopObject& object : *objects) {
    for (ModelSource& source : sources) {
      if (source.name == bop_model_name(object.id) && !object.symmetry.trivial())
        source.symmetry = object.symmetry;
    }
  }
  return {};
}

/// Adds a model of a file without a given name.
void add_unnamed(const fs::path& file, ModelInputs& inputs) {
  const std::string name = model_name_of(file);
  inputs.sources.push_back({name, file, 1, {}, true});
  if (name != cloud_name(file)) {
    inputs.notes.push_back(fmt::format(
        "{}: the model is called {}; NAME=FILE gives it another name", file.string(), name));
  }
}

/// Errors: usage (an invalid or duplicate name), bad_data (an image).
Result<void> check_models(std::span<const ModelSource> sources) {
  std::map<std::string_view, const ModelSource*> by_name;
  for (const ModelSource& source : sources) {
    if (!is_model_name(source.name)) {
      return Error{ErrorCode::usage,
                   fmt::format("{}: expected a name of {}, found '{}'", source.file.string(),
                               kModelNameRule, source.name)};
    }
    const auto [known, is_new] = by_name.emplace(source.name, &source);
    if (!is_new) {
      return Error{ErrorCode::usage,
                   fmt::format("{}: expected each model's name once, found '{}' again, the name of "
                               "{}; name it as NAME=FILE",
                               source.file.string(), source.name, known->second->file.string())};
    }
    if (has_extension(source.file, ".png")) {
      return Error{
          ErrorCode::bad_data,
          fmt::format("{}: expected a mesh or a cloud of the whole object, found an image, "
                      "which shows one side of it",
                      source.file.string())};
    }
  }
  return {};
}

void add_scenes(const Manifest& manifest, LengthUnit library_unit, SceneInputs& inputs) {
  for (SceneInput& source : scenes_of(manifest, library_unit))
    inputs.sources.push_back(std::move(source));
  for (const ManifestScene& scene : manifest.scenes)
    inputs.ids.push_back({scene.scene_id, scene.image_id});
  const bool is_bop = std::ranges::any_of(
      manifest.scenes, [](const ManifestScene& scene) { return scene.scene_id >= 0; });
  if (!is_bop) return;
  for (const ManifestModel& model : manifest.models)
    inputs.object_ids[model.name] = model.object_id;
}

/// Reads each camera of a file once.
class CameraFile {
 public:
  CameraFile(fs::path file, std::optional<int> image_id)
      : file_(std::move(file)), image_id_(image_id) {}

  /// Errors: those of read_camera.
  const Result<Camera>& of(const fs::path& image) {
    const std::optional<int> id = image_id_ ? image_id_ : image_id_of(image);
    const auto known = cameras_.find(id);
    if (known != cameras_.end()) return known->second;
    return cameras_.emplace(id, read_camera(file_, id)).first->second;
  }

 private:
  fs::path file_;
  std::optional<int> image_id_;
  std::map<std::optional<int>, Result<Camera>> cameras_;
};

}  // namespace

LengthUnit parse_unit(const std::string& text) {
  return text == "mm" ? LengthUnit::millimeter : LengthUnit::meter;
}

LengthUnit scene_unit(const SceneInput& scene, LengthUnit library_unit) {
  if (scene.scale == 1) return library_unit;
  return library_unit == LengthUnit::meter ? LengthUnit::millimeter : LengthUnit::meter;
}

bool is_listing(const std::string& argument) {
  return has_extension(argument, ".json") || is_bop_folder(argument);
}

Result<Manifest> read_listing(const std::string& argument) {
  return is_bop_folder(argument) ? read_bop(argument) : read_manifest(argument);
}

Result<ModelInputs> collect_models(const std::vector<std::string>& arguments) {
  ModelInputs inputs;
  for (const std::string& argument : arguments) {
    if (argument == "-") {
      return Error{ErrorCode::usage,
                   "-: expected files, as a library keeps its models' names and hashes, found "
                   "standard input; write the model to a file first"};
    }
    if (is_listing(argument)) {
      // Only the models of a BOP data set: its scenes may be many, or missing.
      const Result<Manifest> manifest =
          is_bop_folder(argument) ? read_bop_models(argument) : read_manifest(argument);
      if (!manifest) return manifest.error();
      if (inputs.unit && *inputs.unit != manifest->unit) {
        return Error{ErrorCode::usage,
                     fmt::format("{}: expected models of one unit, found '{}' after '{}'", argument,
                                 unit_name(manifest->unit), unit_name(*inputs.unit))};
      }
      inputs.unit = manifest->unit;
      const std::vector<ModelSource> listed = models_of(*manifest);
      inputs.sources.insert(inputs.sources.end(), listed.begin(), listed.end());
    } else if (fs::is_directory(argument)) {
      const Result<std::vector<fs::path>> files =
          list_folder(argument, is_cloud_file, inputs.left_out);
      if (!files) return files.error();
      const std::size_t first = inputs.sources.size();
      for (const fs::path& file : *files) add_unnamed(file, inputs);
      const Result<void> declared =
          declare_bop_symmetries(argument, std::span(inputs.sources).subspan(first));
      if (!declared) return declared.error();
    } else if (const std::size_t equals = argument.find('=');
               equals != std::string::npos && !fs::exists(argument)) {
      inputs.sources.push_back({argument.substr(0, equals), argument.substr(equals + 1), 1, {}});
    } else {
      add_unnamed(argument, inputs);
    }
  }
  TRIVET_TRY(check_models(inputs.sources));
  return inputs;
}

std::vector<std::string> left_out_words(const std::vector<std::string>& left_out) {
  constexpr std::size_t kMost = 12;
  struct Names {
    std::vector<std::string> files, folders;
  };
  std::map<std::string, Names> by_folder;
  for (const std::string& path : left_out) {
    const bool is_folder = path.ends_with('/');
    const fs::path name = is_folder ? fs::path(path).parent_path() : fs::path(path);
    Names& names = by_folder[name.parent_path().string()];
    (is_folder ? names.folders : names.files).push_back(name.filename().string());
  }
  const auto listed = [&](const std::vector<std::string>& names) {
    const std::span<const std::string> first(names.data(), std::min(names.size(), kMost));
    const std::string more =
        names.size() > kMost ? fmt::format(" and {} more", names.size() - kMost) : std::string();
    return fmt::format("{}{}", fmt::join(first, ", "), more);
  };
  std::vector<std::string> words;
  for (const auto& [folder, names] : by_folder) {
    std::string text = folder + ": ";
    if (!names.files.empty())
      text += fmt::format("left out, as nothing that can be read: {}", listed(names.files));
    if (!names.folders.empty()) {
      text += fmt::format("{}folders in it are not searched: {}", names.files.empty() ? "" : "; ",
                          listed(names.folders));
    }
    words.push_back(std::move(text));
  }
  return words;
}

Result<LengthUnit> choose_unit(const ModelInputs& inputs, const std::string& given,
                               std::optional<LengthUnit> library) {
  if (inputs.unit && !given.empty() && *inputs.unit != parse_unit(given)) {
    return Error{ErrorCode::usage,
                 fmt::format("--unit: expected '{}' as the models are in, found '{}'",
                             unit_name(*inputs.unit), given)};
  }
  std::optional<LengthUnit> asked = inputs.unit;
  if (!asked && !given.empty()) asked = parse_unit(given);
  if (asked && library && *asked != *library) {
    return Error{
        ErrorCode::usage,
        fmt::format("expected models in '{}', which is the unit of the library, found '{}'; "
                    "write them into another file, or remove this one",
                    unit_name(*library), unit_name(*asked))};
  }
  return asked.value_or(library.value_or(LengthUnit::meter));
}

Result<LengthUnit> choose_unit_into(const std::string& library_file, const ModelInputs& inputs,
                                    const std::string& given, bool prune) {
  const bool is_asked = inputs.unit || !given.empty();
  const Result<Library> library = open_library(library_file);
  if (!library || (prune && is_asked)) return choose_unit(inputs, given);
  const Result<LengthUnit> unit = choose_unit(inputs, given, library->header.unit);
  if (unit) return unit;
  return Error{unit.error().code, fmt::format("{}: {}", library_file, unit.error().message)};
}

namespace {

/// Reads a scan from standard input: its uncompressed bytes and their format.
Result<SceneInput> read_standard_input(SceneInput input) {
  constexpr std::string_view kName = "standard input";
  if (::isatty(STDIN_FILENO) == 1)
    return Error{ErrorCode::usage, "-: expected a scan on standard input, found a terminal"};
  const std::uint64_t limit = ReadOptions{}.max_file_bytes;
  Result<std::vector<std::byte>> bytes = read_all(STDIN_FILENO, kName, limit);
  if (bytes && is_gzip(*bytes)) bytes = gunzip(*bytes, kName, limit);
  if (!bytes) return bytes.error();
  if (input.format.empty()) input.format = format_by_content(*bytes);
  if (input.format.empty() && !bytes->empty()) {
    return Error{
        ErrorCode::usage,
        fmt::format("standard input: its bytes do not identify the format; give --format, one "
                    "of {}",
                    fmt::join(cloud_extensions(), ", "))};
  }
  input.file = "-";
  input.bytes = std::make_shared<const std::vector<std::byte>>(*std::move(bytes));
  return input;
}

}  // namespace

Result<SceneInputs> collect_scenes(const SceneArguments& arguments, LengthUnit library_unit) {
  SceneInput common;
  common.unit = arguments.unit.value_or(library_unit);
  common.scale = unit_scale(*common.unit, library_unit);
  if (!arguments.viewpoint.empty()) {
    common.viewpoint =
        Eigen::Vector3d(arguments.viewpoint[0], arguments.viewpoint[1], arguments.viewpoint[2]);
  }

  SceneInputs inputs;
  CameraFile cameras(arguments.camera, arguments.image_id);
  for (const std::string& argument : arguments.scenes) {
    if (argument == "-") {
      if (std::ranges::any_of(inputs.sources, [](const SceneInput& s) { return bool{s.bytes}; }))
        return Error{ErrorCode::usage, "-: expected standard input once, found it again"};
      SceneInput asked = common;
      asked.format = arguments.format;
      if (!arguments.camera.empty()) {
        const Result<Camera> camera = cameras.of("-");
        if (!camera) return camera.error();
        asked.camera = *camera;
      }
      Result<SceneInput> read = read_standard_input(std::move(asked));
      if (!read) return read.error();
      inputs.sources.push_back(*std::move(read));
      inputs.ids.emplace_back();
      continue;
    }
    if (is_listing(argument)) {
      const Result<Manifest> manifest = read_listing(argument);
      if (!manifest) return manifest.error();
      add_scenes(*manifest, library_unit, inputs);
      continue;
    }
    std::vector<fs::path> files{argument};
    const bool is_folder = fs::is_directory(argument);
    if (is_folder) {
      Result<std::vector<fs::path>> listed = list_folder(
          argument,
          [&](const fs::path& file) {
            return is_cloud_file(file) || (!arguments.camera.empty() && is_depth_file(file));
          },
          inputs.left_out);
      if (!listed) return listed.error();
      files = std::move(*listed);
    }
    for (const fs::path& file : files) {
      inputs.sources.push_back(common);
      inputs.sources.back().file = file;
      if (!is_folder) inputs.sources.back().format = arguments.format;
      inputs.ids.emplace_back();
      if (arguments.camera.empty()) continue;
      const Result<Camera> camera = cameras.of(file);
      if (!camera) return camera.error();
      inputs.sources.back().camera = *camera;
    }
  }
  return inputs;
}

}  // namespace trivet::apps
