/// Export of a library's surfaces to files for other programs.
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
  /// FOLDER/models/obj_000001.ply ... in mm, models_info.json next to them with the symmetries, and
  /// FOLDER/manifest.json with the names
  bop,
};

/// Write vertices and triangles of models. Models trained from these files are identical bit by
/// bit; in BOP's format this holds for libraries in millimeters, and otherwise they agree up to the
/// last digit.
///
/// names  empty: all models
/// Returns the files that trivet train accepts. Errors: usage (no such model; too large for glTF),
/// damaged, cannot_create, io.
Result<std::vector<std::filesystem::path>> export_models(const Library& library,
                                                         std::span<const std::string> names,
                                                         SurfaceFormat format,
                                                         const std::filesystem::path& folder);

}  // namespace trivet
