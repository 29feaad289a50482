/// The JSON format of `trivet recognize --json`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/recognition/recognize.hpp"
#include "storage/data/file_pose.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet::apps {

/// The name in JSON: "too_low", "explained" or "too_many".
std::string_view name_of(Rejection reason);

/// The pose as four rows of four numbers.
nlohmann::ordered_json matrix_json(const FilePose& pose);

/// One element of "scenes", with the evidence of the score that was used in the recognition, and
/// with "explanation" if the result has one.
///
/// options  options of the recognition; they also decide whether rejected poses and the reasons in
///          words are included
nlohmann::ordered_json scene_json(const std::string& file, const SceneResult& result,
                                  const kernels::ScoreModel& score,
                                  const RecognizeOptions& options);

/// The element of a scene that could not be read or recognized: {"scene", "error"}, without
/// detections.
nlohmann::ordered_json failed_scene_json(const std::string& file, const Error& error);

/// The result of a check of a camera: the "camera_check" of a scene, an element of "cameras".
nlohmann::ordered_json camera_check_json(const CameraCheck& check);

/// Reads the poses of all scenes of such a document as expected poses. Errors: as read_detections.
Result<std::vector<ExpectedPose>> read_expected_poses(const std::filesystem::path& file);

/// A scene of such a document.
struct StoredScene {
  std::filesystem::path file;
  SceneResult result;
};

/// Reads all scenes of a document. Any program may have written it. Each scene must have "scene"
/// and "detections"; scenes with "error" in place of these are left out. Each detection must have
/// "model", "score" and "T_scene_model"; missing numbers are NaN, times are ignored.
/// Errors: missing_input, io, bad_data (names the JSON path of the fault).
Result<std::vector<StoredScene>> read_stored_scenes(const std::filesystem::path& file);

/// Reads the detections of a manifest's scenes, one result per scene; none for a scene that the
/// file does not contain. Scenes are matched by path, or else by the end of the path if that is
/// unique.
/// Errors: as read_stored_scenes.
Result<std::vector<std::optional<SceneResult>>> read_detections(const std::filesystem::path& file,
                                                                const Manifest& manifest);

}  // namespace trivet::apps
