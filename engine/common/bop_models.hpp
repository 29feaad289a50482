/// Models as the folder of a BOP data set has them.
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

/// What BOP keeps of a model.
struct BopModel {
  std::string name;
  PointsView vertices;
  TrianglesView triangles;
  Symmetry symmetry;
};

/// Write meshes in millimeters as FOLDER/models/obj_000001.ply ... in their order, with their
/// diameters, boxes and symmetries in FOLDER/models/models_info.json; the same in further folders.
///
/// unit  of the models
/// Returns what a manifest of `manifest_unit` says of them. Errors: cannot_create, io.
Result<std::vector<ManifestModel>> write_bop_models(
    std::span<const BopModel> models, LengthUnit unit, LengthUnit manifest_unit,
    const std::filesystem::path& folder, std::initializer_list<const char*> further = {});

}  // namespace trivet::engine
