/// Models in the folder structure of a BOP data set.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/data/length_unit.hpp"
#include "storage/data/model.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet::engine {

/// Data of a model in BOP.
struct BopModel {
  std::string name;
  PointsView vertices;
  TrianglesView triangles;
  Symmetry symmetry;
};

/// Write meshes in millimeters as FOLDER/models/obj_000001.ply ... in their order, with their
/// diameters, boxes and symmetries in FOLDER/models/models_info.json. Further folders receive the
/// same files.
///
/// unit  unit of the models
/// Returns the models' entries for a manifest of `manifest_unit`. Errors: cannot_create, io.
Result<std::vector<ManifestModel>> write_bop_models(
    std::span<const BopModel> models, LengthUnit unit, LengthUnit manifest_unit,
    const std::filesystem::path& folder, std::initializer_list<const char*> further = {});

}  // namespace trivet::engine
