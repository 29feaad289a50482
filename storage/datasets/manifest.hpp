/// Manifests: JSON that names models with their symmetries and scenes with their cameras and truth.
/// Occlusion and clutter are those of Drost et al., CVPR 2010, section 5.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/file_pose.hpp"
#include "storage/data/model.hpp"
#include "storage/library/library.hpp"

namespace trivet {

/// A model that is listed.
struct ManifestModel {
  std::string name;
  std::filesystem::path file;  ///< relative paths of the manifest are resolved against its folder
  double scale = 1;            ///< multiplies the file's coordinates, giving the manifest's unit
  std::optional<Symmetry> symmetry;      ///< absent: to be found by the program
  std::filesystem::path eval_file = {};  ///< mesh that errors are measured on; empty: `file`
  int object_id = 0;                     ///< of BOP, where scenes have their ids
  std::optional<double> diameter = {};   ///< that errors are measured in, where a data set says
};

/// An object that a scene is known to hold.
struct TruthInstance {
  std::string model;
  Pose T_scene_model;
  std::optional<double> occlusion;  ///< 0..1: share of the surface's area that the sensor lacks
  bool ignore = false;              ///< too little of it is visible: counts neither way
  std::optional<double> visible_fraction = {};  ///< 0..1, of the silhouette's pixels (BOP)
  std::optional<double> clutter = {};  ///< 0..1: share of the scene's area that others have
  /// What rounding to floats took off the translation: of scenes far from zero more than a little.
  Eigen::Vector3d rounded_off{0, 0, 0};

  FilePose file_pose() const { return in_file_frame(T_scene_model, rounded_off); }
};

/// How many instances of a model a scene is known to hold, where that is told to the recognizer.
struct SceneTarget {
  std::string model;
  std::uint32_t num_instances = 1;
};

/// A scene that is listed.
struct ManifestScene {
  std::filesystem::path file;  ///< resolved
  std::string name;            ///< as written in the manifest
  std::optional<Camera> camera;
  std::optional<Eigen::Vector3d> viewpoint;  ///< in the frame of the scene's file
  bool closed_surface = false;  ///< neither camera nor viewpoint: a surface without a sensor
  std::vector<TruthInstance> truth;
  std::vector<SceneTarget> targets = {};  ///< of BOP's localization task; empty: not given
  int scene_id = -1, image_id = -1;       ///< BOP; -1: none
};

/// Models, scenes, and what is known of them: what a manifest or a BOP data set lists.
struct Manifest {
  LengthUnit unit = LengthUnit::meter;
  std::vector<ManifestModel> models;       ///< in the order of the file
  std::vector<std::string> models_scored;  ///< empty: all
  std::vector<ManifestScene> scenes;
};

/// Errors: missing_input, bad_data (names the JSON path of the fault).
Result<Manifest> read_manifest(const std::filesystem::path& file);

/// Write a manifest that reads back the same. The files of models and scenes are named relative to
/// its folder. The file appears whole or not at all. Errors: cannot_create, io.
Result<void> write_manifest(const std::filesystem::path& file, const Manifest& manifest);

}  // namespace trivet
