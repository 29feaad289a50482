#include "apps/program/recognize_request.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "apps/options/add_options.hpp"
#include "apps/report/recognition_report.hpp"
#include "apps/results/bop_csv.hpp"
#include "apps/results/robot_poses.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::apps {

void add_scene_command(CLI::App& command, SceneCommand& arguments) {
  command.add_option("LIBRARY", arguments.library, "Library file, made by `trivet train`")
      ->required();
  command
      .add_option(
          "SCENE", arguments.scenes.scenes,
          "Scans (PLY, PCD, OBJ, STL, OFF, XYZ, glTF, NPY), depth images (PNG, TIFF, NPY), packed "
          "by gzip or not, folders, manifests, or BOP data sets (the folder, or that of one "
          "split); - "
          "for standard input")
      ->required();
  const std::span<const std::string_view> formats = cloud_extensions();
  limit_to(command.add_option(
               "--format", arguments.scenes.format,
               fmt::format("Format of the files and of standard input: {}; default: as the name "
                           "tells, else how the bytes begin",
                           fmt::join(formats, ", "))),
           {formats.begin(), formats.end()})
      ->type_name("NAME");
  command
      .add_option("--unit", arguments.unit, "Unit of the scenes, m or mm; default: the library's")
      ->check(CLI::IsMember({"m", "mm"}));
  command
      .add_option(
          "--camera", arguments.scenes.camera,
          "Camera of depth images: JSON with fx fy cx cy depth_scale, or BOP's scene_camera.json")
      ->type_name("FILE");
  command
      .add_option("--image-id", arguments.scenes.image_id,
                  "Image of scene_camera.json whose camera --camera takes; default: the number "
                  "that is the scene's file name, as in 000003.png")
      ->check(CLI::NonNegativeNumber);
  command
      .add_option(
          "--viewpoint", arguments.scenes.viewpoint,
          "Position x,y,z of the sensor in the scene's frame; default: the file's, else where all "
          "faces of a mesh are seen from, else the origin")
      ->delimiter(',')
      ->expected(3);
  command
      .add_option("--json", arguments.json,
                  "Write the result as JSON to this file, - for standard output")
      ->type_name("FILE");
  command
      .add_option("--report", arguments.report,
                  "Write index.html with pictures of what was found, and of what was rejected "
                  "and why, into this folder")
      ->type_name("FOLDER");
  command
      .add_option("--bop-csv", arguments.bop_csv,
                  "Write the poses found in BOP data sets to this file, as BOP takes them: also "
                  "those that are too low to be reported, down to a score of 0.1")
      ->type_name("FILE");
  command
      .add_option("--coco", arguments.coco,
                  "Write masks and boxes of the same poses to this file (JSON), as BOP takes them "
                  "for detection and segmentation in images")
      ->type_name("FILE");
  command
      .add_option("--robot-csv", arguments.robot_csv,
                  "Write the poses found to this file as a table that a robot's program takes")
      ->type_name("FILE");
  CLI::Option* const table = command.get_option("--robot-csv");
  std::vector<std::string_view> conventions;
  for (const Choice& choice : choices_of<RobotConvention>()) conventions.push_back(choice.name);
  limit_to(command.add_option("--robot", arguments.robot,
                              fmt::format("How its controller writes poses: {}; default: {}",
                                          fmt::join(conventions, ", "), conventions.front())),
           {conventions.begin(), conventions.end()})
      ->type_name("NAME")
      ->needs(table);
  command
      .add_option("--robot-frame", arguments.robot_frame,
                  "Pose of the scene's frame in the robot's, of a hand-eye calibration, in the "
                  "scene's unit: JSON, four rows of four numbers")
      ->type_name("FILE")
      ->needs(table);
  command
      .add_option("--grasps", arguments.grasps,
                  "Frames of models to grasp by, in the library's unit: JSON, "
                  "{\"MODEL\": {\"GRASP\": four rows of four numbers}}")
      ->type_name("FILE")
      ->needs(table);
  add_open_options(command, arguments.opening);
  command.add_flag("--estimate-camera", arguments.estimate_camera,
                   "Where sure detections say that the focal length or the depth scale of depth "
                   "images is wrong, correct it and recognize once more");
  add_recognize_options(command, arguments.recognize);
}

Result<RecognitionRequest> make_request(const SceneCommand& arguments, const Console& console) {
  Result<Recognizer> opened = open_recognizer(arguments.library, arguments.opening);
  if (!opened) return opened.error();
  const Library& library = opened->library();
  SceneArguments scene_arguments = arguments.scenes;
  if (!arguments.unit.empty()) scene_arguments.unit = parse_unit(arguments.unit);
  Result<SceneInputs> scenes = collect_scenes(scene_arguments, library.header.unit);
  if (!scenes) return scenes.error();
  for (const std::string& words : left_out_words(scenes->left_out)) console.warning(words);
  Result<RecognizeOptions> options = recognize_options(arguments.recognize);
  if (!options) return options.error();
  if (arguments.json.empty()) options->max_rejected = 1;  // the best one is told of an empty scene
  if (!arguments.report.empty()) options->max_rejected = kToldPerModel;
  RecognizeOptions kept = *options;
  std::vector<std::string> bop_files{arguments.bop_csv, arguments.coco};
  std::erase(bop_files, "");
  if (!bop_files.empty()) {
    const Result<void> checked = check_bop_ids(*scenes, library, options->models);
    if (!checked) return checked.error();
    for (const std::string& file : bop_files)
      if (const auto warning = bop_name_warning(file)) console.warning(*warning);
    kept.doubtful_score = std::min(kLowestKeptScore, options->min_score);
  }
  return RecognitionRequest{std::move(*opened), std::move(*scenes), std::move(*options),
                            std::move(kept)};
}

}  // namespace trivet::apps
