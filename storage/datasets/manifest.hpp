/// Manifests: JSON files that list models with their symmetries, and scenes with their cameras and
/// ground truth. Occlusion and clutter are defined as by Drost et al., CVPR 2010, section 5.
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

/// A model of a manifest.
struct ManifestModel {
  std::string name;
  std::filesystem::path file;  ///< relative paths of the manifest are resolved against its folder
  double scale = 1;            ///< factor from the file's coordinates to the manifest's unit
  std::optional<Symmetry> symmetry;      ///< absent: to be determined by the program
  std::filesystem::path eval_file = {};  ///< mesh for computing errors; empty: `file`
  int object_id = 0;                     ///< BOP object id
  std::optional<double> diameter = {};  ///< diameter for normalizing errors, if the data set states
                                        ///< it
};

/// An object of a scene's ground truth.
struct TruthInstance {
  std::string model;
  Pose T_scene_model;
  std::optional<double> occlusion;  ///< 0..1: share of the surface area missing in the scan
  bool ignore = false;              ///< visible part too small: counts neither way
  std::optional<double> visible_fraction = {};  ///< 0..1, share of the silhouette's pixels (BOP)
  std::optional<double> clutter = {};  ///< 0..1: share of the scene's area on other objects
  /// Rounding error of the translation as floats; notable for scenes far from zero.
  Eigen::Vector3d rounded_off{0, 0, 0};

  FilePose file_pose() const { return in_file_frame(T_scene_model, rounded_off); }
};

/// Known number of instances of a model in a scene, passed to the recognizer if given.
struct SceneTarget {
  std::string model;
  std::uint32_t num_instances = 1;
};

/// A scene of a manifest.
struct ManifestScene {
  std::filesystem::path file;  ///< resolved path
  std::string name;            ///< as written in the manifest
  std::optional<Camera> camera;
  std::optional<Eigen::Vector3d> viewpoint;  ///< position of the sensor in the frame of the scene's
                                             ///< file
  bool closed_surface = false;  ///< neither camera nor viewpoint: a surface without a sensor
  std::vector<TruthInstance> truth;
  std::vector<SceneTarget> targets = {};  ///< targets of BOP's localization task; empty: not given
  int scene_id = -1, image_id = -1;       ///< BOP; -1: none
};

/// Models, scenes and ground truth of a manifest or a BOP data set.
struct Manifest {
  LengthUnit unit = LengthUnit::meter;
  std::vector<ManifestModel> models;       ///< in the order of the file
  std::vector<std::string> models_scored;  ///< models to be scored; empty: all
  std::vector<ManifestScene> scenes;
};

/// Errors: missing_input, bad_data (names the JSON path of the fault).
Result<Manifest> read_manifest(const std::filesystem::path& file);

/// Write a manifest that reads back unchanged. Paths of models and scenes are written relative to
/// its folder. The file appears whole or not at all. Errors: cannot_create, io.
Result<void> write_manifest(const std::filesystem::path& file, const Manifest& manifest);

}  // namespace trivet
