#include <fmt/format.h>

#include <memory>

#include "apps/commands.hpp"
#include "apps/detections_json.hpp"
#include "apps/inputs.hpp"
#include "apps/presets.hpp"
#include "storage/file.hpp"

namespace trivet::apps {
namespace {

struct RecognizeArguments {
  std::string library, method = "ppf", preset = "balanced", unit, models, json;
  SceneArguments scenes;
  std::optional<float> min_score, reference_share, neighbour_share;
  std::optional<std::uint32_t> max_instances, max_votes;
};

RecogniseOptions options_of(const RecognizeArguments& arguments) {
  RecogniseOptions options = recognise_presets().at(arguments.preset);
  if (arguments.min_score) options.min_score = *arguments.min_score;
  if (arguments.reference_share) options.vote.reference_share = *arguments.reference_share;
  if (arguments.neighbour_share) options.vote.neighbour_share = *arguments.neighbour_share;
  if (arguments.max_votes) options.vote.max_votes = *arguments.max_votes;
  if (arguments.max_instances) options.max_instances = *arguments.max_instances;
  options.models = CLI::detail::split(arguments.models, ',');
  if (arguments.models.empty()) options.models.clear();
  return options;
}

void print_scene(const std::string& file, const SceneResult& result) {
  fmt::print("{}: {} points, {:.3f} s, {} found\n", file, result.stats.num_points, result.stats.total_seconds,
             result.detections.size());
  for (const Detection& detection : result.detections) {
    const Eigen::Vector3f t = detection.T_scene_model.translation();
    fmt::print("  {:<24} score {:.3f}  visible {:.2f}  rmse {:.3g}  at ({:.4g}, {:.4g}, {:.4g})\n", detection.model,
               detection.score, detection.visible_fraction, detection.rmse, t.x(), t.y(), t.z());
  }
}

Result<void> recognize(const RecognizeArguments& arguments, const Context& context) {
  const Result<Library> library = open_library(arguments.library);
  if (!library) return library.error();
  SceneArguments scene_arguments = arguments.scenes;
  if (!arguments.unit.empty()) scene_arguments.unit = parse_unit(arguments.unit);
  const Result<std::vector<SceneInput>> scenes = collect_scenes(scene_arguments, library->header.unit);
  if (!scenes) return scenes.error();

  nlohmann::ordered_json document{{"library", arguments.library}, {"scenes", nlohmann::ordered_json::array()}};
  const Result<void> done = recognise_all(
      *library, *scenes, options_of(arguments), context.console.progress("recognised", context.stop),
      [&](std::size_t index, const SceneResult& result) {
        const std::string file = (*scenes)[index].file.string();
        if (arguments.json.empty()) {
          print_scene(file, result);
        } else {
          document["scenes"].push_back(scene_json(file, result));
        }
      });
  if (!done) return done;
  if (arguments.json.empty()) return {};
  const std::string text = document.dump(1) + "\n";
  if (arguments.json == "-") {
    fmt::print("{}", text);
    return {};
  }
  return publish_file(arguments.json, std::as_bytes(std::span(text)));
}

}  // namespace

void add_recognize(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<RecognizeArguments>();
  CLI::App* command = app.add_subcommand("recognize", "Find the models of a library in scenes");
  command->add_option("LIBRARY", arguments->library, "Library file, made by `trivet train`")->required();
  command->add_option("SCENE", arguments->scenes.scenes,
                      "Scans (PLY, PCD, OBJ, STL, OFF, XYZ), 16-bit depth PNGs, folders, or manifests")
      ->required();
  command->add_option("--method", arguments->method, "ppf: point-pair features")
      ->check(CLI::IsMember({"ppf"}))
      ->capture_default_str();
  command->add_option("--preset", arguments->preset, "fast, balanced or accurate")
      ->check(CLI::IsMember({"fast", "balanced", "accurate"}))
      ->capture_default_str();
  command->add_option("--unit", arguments->unit, "Unit of the scenes, m or mm; default: the library's")
      ->check(CLI::IsMember({"m", "mm"}));
  command->add_option("--min-score", arguments->min_score, "Detections below are not reported, 0 to 1 (default 0.5)");
  command->add_option("--max-instances", arguments->max_instances, "Per model and scene (default 100)");
  command->add_option("--reference-share", arguments->reference_share,
                      "Share of the sampled scene points that vote, above 0 to 1; overrides the preset");
  command->add_option("--neighbour-share", arguments->neighbour_share,
                      "Outer share of a feature bin in which the adjoining cell votes too, 0 to 0.5");
  command->add_option("--max-votes", arguments->max_votes,
                      "Votes of a reference point for a model; fewer is faster (default 60000)");
  command->add_option("--models", arguments->models, "Only these models, as a,b,c");
  command->add_option("--camera", arguments->scenes.camera,
                      "Camera of depth images: JSON with fx fy cx cy depth_scale, or BOP's scene_camera.json");
  command->add_option("--viewpoint", arguments->scenes.viewpoint,
                      "Position x,y,z of the sensor in the scene's frame; default: the file's, else the origin")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--json", arguments->json, "Write the result as JSON to this file, - for standard output");
  command->callback(
      [arguments, &context] { context.run = [arguments, &context] { return recognize(*arguments, context); }; });
}

}  // namespace trivet::apps
