/// Manifests: JSON that names models with their symmetries and scenes with their cameras and truth.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "storage/cloud.hpp"
#include "storage/library.hpp"
#include "storage/model.hpp"
#include "storage/result.hpp"

namespace trivet {

struct ManifestModel {
  std::string name;
  std::filesystem::path file;  ///< relative paths of the manifest are resolved against its folder
  double scale = 1;            ///< multiplies the file's coordinates, giving the manifest's unit
  std::optional<Symmetry> symmetry;  ///< absent: to be found by the program
};

struct TruthInstance {
  std::string model;
  Pose T_scene_model;
  std::optional<double> occlusion;  ///< 0..1
  bool ignore = false;              ///< too little of it is visible: counts neither way
};

struct ManifestScene {
  std::filesystem::path file;  ///< resolved
  std::string name;            ///< as written in the manifest
  std::optional<Camera> camera;
  std::optional<Eigen::Vector3f> viewpoint;
  bool closed_surface = false;  ///< neither camera nor viewpoint: a surface without a sensor
  std::vector<TruthInstance> truth;
};

struct Manifest {
  LengthUnit unit = LengthUnit::metre;
  std::vector<ManifestModel> models;       ///< in the order of the file
  std::vector<std::string> models_scored;  ///< empty: all
  std::vector<ManifestScene> scenes;
};

/// Errors: missing_input, bad_data (names the JSON path of the fault).
Result<Manifest> read_manifest(const std::filesystem::path& file);

/// Write a manifest that reads back the same. The files of models and scenes are named relative to
/// its folder. The file appears whole or not at all. Errors: cannot_create, io.
Result<void> write_manifest(const std::filesystem::path& file, const Manifest& manifest);

/// Symmetries from a BOP models_info.json (lengths in mm, scaled by `scale`), by object id.
/// Errors: missing_input, bad_data.
Result<std::vector<std::pair<int, Symmetry>>> read_bop_symmetries(const std::filesystem::path& file,
                                                                  double scale);

}  // namespace trivet
