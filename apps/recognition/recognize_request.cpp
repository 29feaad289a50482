#include "apps/recognition/recognize_request.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "apps/options/add_options.hpp"
#include "apps/report/recognition_report.hpp"
#include "apps/results/bop_csv.hpp"
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
  add_output_options(command, arguments.outputs);
  add_open_options(command, arguments.opening);
  command.add_flag("--estimate-camera", arguments.estimate_camera,
                   "Where sure detections say that the focal length or the depth scale of depth "
                   "images is wrong, correct it and recognize once more");
  add_recognize_options(command, arguments.recognize);
}

Result<RecognitionRequest> make_request(const SceneCommand& arguments, const Console& console) {
  Result<RecognizeOptions> options = recognize_options(arguments.recognize);
  if (!options) return options.error();
  Result<Recognizer> opened = open_recognizer(arguments.library, arguments.opening);
  if (!opened) return opened.error();
  const Library& library = opened->library();
  SceneArguments scene_arguments = arguments.scenes;
  if (!arguments.unit.empty()) scene_arguments.unit = parse_unit(arguments.unit);
  Result<SceneInputs> scenes = collect_scenes(scene_arguments, library.header.unit);
  if (!scenes) return scenes.error();
  for (const std::string& words : left_out_words(scenes->left_out)) console.warning(words);
  const OutputArguments& outputs = arguments.outputs;
  if (outputs.json.empty()) options->max_rejected = 1;  // text shows the best one of an empty scene
  if (!outputs.report.empty()) options->max_rejected = kRejectedPerModel;
  RecognizeOptions kept = *options;
  std::vector<std::string> bop_files{outputs.bop_csv, outputs.coco};
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
