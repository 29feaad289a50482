/// The JSON that `trivet recognize --json` writes.
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

/// "too_low", "explained", "too_many".
std::string_view name_of(Rejection reason);

/// Four rows of four numbers.
nlohmann::ordered_json matrix_json(const FilePose& pose);

/// One element of "scenes", with the evidence of the score that it was recognized with, and with
/// "explanation" where the result holds one.
///
/// options  that it was asked for with; what was rejected is told, with the reasons in words, where
///          they say so
nlohmann::ordered_json scene_json(const std::string& file, const SceneResult& result,
                                  const kernels::ScoreModel& score,
                                  const RecognizeOptions& options);

/// The same of a scene that could not be read or recognized: {"scene", "error"}, without detections.
nlohmann::ordered_json failed_scene_json(const std::string& file, const Error& error);

/// What a check of a camera told; the "camera_check" of a scene, an element of "cameras".
nlohmann::ordered_json camera_check_json(const CameraCheck& check);

/// The poses of all scenes of such a document, as expected ones. Errors: as read_detections.
Result<std::vector<ExpectedPose>> read_expected_poses(const std::filesystem::path& file);

/// A scene of such a document.
struct StoredScene {
  std::filesystem::path file;
  SceneResult result;
};

/// All of them. Any program may have written them: per scene "scene" and "detections" must be there,
/// or "error" instead of these, which are left out; per detection "model", "score" and "T_scene_model"; numbers that are not told are NaN, times are
/// left out. Errors: missing_input, io, bad_data (names the JSON path of the fault).
Result<std::vector<StoredScene>> read_stored_scenes(const std::filesystem::path& file);

/// Read the detections of a manifest's scenes, one result a scene; none for a scene that is not
/// there. Scenes are joined by path, else by the end of the path, where that names one of them.
/// Errors: as read_stored_scenes.
Result<std::vector<std::optional<SceneResult>>> read_detections(const std::filesystem::path& file,
                                                                const Manifest& manifest);

}  // namespace trivet::apps
