/// Surfaces of a library's models as files that other programs read.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet {

enum class SurfaceFormat {
  ply,   ///< FOLDER/NAME.ply, in the library's unit
  gltf,  ///< FOLDER/NAME.glb, in meters by the scale of a node
  /// FOLDER/models/obj_000001.ply ... in mm, models_info.json beside them with the symmetries, and
  /// FOLDER/manifest.json with the names
  bop,
};

/// Write vertices and triangles of models. Trained from what was written, they are the same to the
/// bit: in BOP's form where the library is in millimeters, else to the last digit.
///
/// names  none: all models
/// Returns the files that trivet train takes. Errors: usage (no such model; too large for glTF),
/// bad_data (damaged), cannot_create, io.
Result<std::vector<std::filesystem::path>> export_models(const Library& library,
                                                         std::span<const std::string> names,
                                                         SurfaceFormat format,
                                                         const std::filesystem::path& folder);

}  // namespace trivet
