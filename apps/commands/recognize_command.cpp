#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/inputs/inputs.hpp"
#include "apps/inputs/open_recognizer.hpp"
#include "apps/options/add_options.hpp"
#include "apps/options/recognize_arguments.hpp"
#include "apps/report/recognition_report.hpp"
#include "apps/results/bop_csv.hpp"
#include "apps/results/coco_results.hpp"
#include "apps/results/detections_json.hpp"
#include "apps/results/json_output.hpp"
#include "apps/results/recognition_text.hpp"
#include "apps/results/reported_part.hpp"
#include "apps/results/standard_output.hpp"
#include "engine/estimate_camera.hpp"
#include "storage/read_cloud.hpp"

namespace trivet::apps {
namespace {

struct CommandArguments {
  std::string library, unit, json, bop_csv, coco, report;
  OpenOptions opening;
  SceneArguments scenes;
  RecognizeArguments recognize;
  bool estimate_camera = false;
};

/// Recognize the scenes, one after the other to `emit`; with the cameras that were estimated, if
/// that is asked for.
Result<void> recognize_scenes(const Recognizer& recognizer, std::span<SceneInput> scenes,
                              const RecognizeOptions& options, bool estimate_camera,
                              const Progress& progress,
                              const std::function<void(std::size_t, const SceneResult&)>& emit) {
  if (!estimate_camera) return recognize_all(recognizer, scenes, options, progress, emit);
  const Result<std::vector<SceneResult>> results =
      recognize_estimating_camera(recognizer, scenes, options, progress);
  if (!results) return results.error();
  for (std::size_t s = 0; s < results->size(); ++s) emit(s, (*results)[s]);
  return {};
}

Result<void> recognize(const CommandArguments& arguments, const Context& context) {
  const Result<Recognizer> opened = open_recognizer(arguments.library, arguments.opening);
  if (!opened) return opened.error();
  const Recognizer& recognizer = *opened;
  const Library& library = recognizer.library();
  SceneArguments scene_arguments = arguments.scenes;
  if (!arguments.unit.empty()) scene_arguments.unit = parse_unit(arguments.unit);
  Result<SceneInputs> scenes = collect_scenes(scene_arguments, library.header.unit);
  if (!scenes) return scenes.error();
  Result<RecognizeOptions> options = recognize_options(arguments.recognize);
  if (!options) return options.error();
  if (arguments.json.empty()) options->max_rejected = 1;  // the best one is told of an empty scene
  if (!arguments.report.empty()) options->max_rejected = kToldPerModel;
  RecognizeOptions kept = *options;
  std::vector<std::string> bop_files{arguments.bop_csv, arguments.coco};
  std::erase(bop_files, "");
  if (!bop_files.empty()) {
    const Result<void> checked = check_bop_ids(*scenes, library, options->models);
    if (!checked) return checked;
    for (const std::string& file : bop_files)
      if (const auto warning = bop_name_warning(file)) context.console.warning(*warning);
    kept.doubtful_score = std::min(kLowestKeptScore, options->min_score);
  }

  nlohmann::ordered_json document{{"library", arguments.library},
                                  {"calibration", calibration_json(recognizer)},
                                  {"scenes", nlohmann::ordered_json::array()},
                                  {"cameras", nlohmann::ordered_json::array()}};
  std::vector<BopResult> bop_results;
  std::vector<CocoResult> coco_results;
  Result<void> seen;              // in the depth images
  std::vector<SceneResult> told;  // for the report
  std::vector<CameraCheck> checks;
  Result<void> printed;  // what fails first, which more would not mend
  const Result<void> done = recognize_scenes(
      recognizer, scenes->sources, kept, arguments.estimate_camera,
      context.console.progress("recognized", context.stop),
      [&](std::size_t index, const SceneResult& all) {
        if (!arguments.bop_csv.empty()) add_bop_results(*scenes, index, all, bop_results);
        if (!arguments.coco.empty() && seen)
          seen = add_coco_results(*scenes, index, recognizer, all, coco_results);
        const SceneResult result = reported_part(all, kept);
        const SceneInput& scene = scenes->sources[index];
        if (!arguments.json.empty()) {
          document["scenes"].push_back(scene_json(scene.file.string(), result, recognizer.score()));
        } else if (printed) {
          printed = write_output(scene_text(scene, result, library, options->min_score));
        }
        if (!arguments.report.empty()) told.push_back(result);
        if (result.stats.camera_check) checks.push_back(*result.stats.camera_check);
      });
  if (!done) return done;
  if (!seen) return seen;
  for (const CameraCheck& check : join_checks(checks)) {
    document["cameras"].push_back(camera_check_json(check));
    if (arguments.json.empty() && printed) printed = write_output(camera_text(check));
  }
  if (!printed) return printed;
  if (!arguments.bop_csv.empty()) {
    const Result<void> written = write_bop_results(arguments.bop_csv, bop_results);
    if (!written) return written;
  }
  if (!arguments.coco.empty()) {
    const Result<void> written = write_coco_results(arguments.coco, coco_results);
    if (!written) return written;
  }
  if (!arguments.json.empty()) {
    const Result<void> written = write_json(arguments.json, document);
    if (!written) return written;
  }
  if (arguments.report.empty()) return {};
  const Result<void> drawn = write_recognition_report(
      arguments.report, {recognizer, *options, scenes->sources, told, context.command},
      context.console.progress("drawn", context.stop));
  if (drawn) context.console.wrote_report(arguments.report);
  return drawn;
}

}  // namespace

void add_recognize(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<CommandArguments>();
  CLI::App* command = app.add_subcommand("recognize", "Find the models of a library in scenes");
  command->add_option("LIBRARY", arguments->library, "Library file, made by `trivet train`")
      ->required();
  command
      ->add_option(
          "SCENE", arguments->scenes.scenes,
          "Scans (PLY, PCD, OBJ, STL, OFF, XYZ, glTF, NPY), depth images (PNG, TIFF, NPY), packed "
          "by gzip or not, folders, manifests, or BOP data sets (the folder, or that of one "
          "split); - "
          "for standard input")
      ->required();
  const std::span<const std::string_view> formats = cloud_extensions();
  limit_to(command->add_option(
               "--format", arguments->scenes.format,
               fmt::format("Format of the files and of standard input: {}; default: as the name "
                           "tells, else how the bytes begin",
                           fmt::join(formats, ", "))),
           {formats.begin(), formats.end()})
      ->type_name("NAME");
  command
      ->add_option("--unit", arguments->unit, "Unit of the scenes, m or mm; default: the library's")
      ->check(CLI::IsMember({"m", "mm"}));
  command
      ->add_option(
          "--camera", arguments->scenes.camera,
          "Camera of depth images: JSON with fx fy cx cy depth_scale, or BOP's scene_camera.json")
      ->type_name("FILE");
  command
      ->add_option("--image-id", arguments->scenes.image_id,
                   "Image of scene_camera.json whose camera --camera takes; default: the number "
                   "that is the scene's file name, as in 000003.png")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option(
          "--viewpoint", arguments->scenes.viewpoint,
          "Position x,y,z of the sensor in the scene's frame; default: the file's, else where all "
          "faces of a mesh are seen from, else the origin")
      ->delimiter(',')
      ->expected(3);
  command
      ->add_option("--json", arguments->json,
                   "Write the result as JSON to this file, - for standard output")
      ->type_name("FILE");
  command
      ->add_option("--report", arguments->report,
                   "Write index.html with pictures of what was found, and of what was rejected "
                   "and why, into this folder")
      ->type_name("FOLDER");
  command
      ->add_option("--bop-csv", arguments->bop_csv,
                   "Write the poses found in BOP data sets to this file, as BOP takes them: also "
                   "those that are too low to be reported, down to a score of 0.1")
      ->type_name("FILE");
  command
      ->add_option("--coco", arguments->coco,
                   "Write masks and boxes of the same poses to this file (JSON), as BOP takes them "
                   "for detection and segmentation in images")
      ->type_name("FILE");
  add_open_options(*command, arguments->opening);
  command->add_flag("--estimate-camera", arguments->estimate_camera,
                    "Where sure detections say that the focal length or the depth scale of depth "
                    "images is wrong, correct it and recognize once more");
  add_recognize_options(*command, arguments->recognize);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return recognize(*arguments, context); };
  });
}

}  // namespace trivet::apps
