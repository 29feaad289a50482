#include "engine/libraries/export_models.hpp"

#include "engine/common/bop_models.hpp"
#include "engine/libraries/edit_library.hpp"
#include "storage/files/file.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

/// A model to export.
struct Exported {
  const ModelInfo& model;
  const ModelSurface& surface;
};

/// The models with these names, or all models.
Result<std::vector<Exported>> models_named(const Library& library,
                                           std::span<const std::string> names) {
  std::vector<std::uint32_t> wanted;
  for (const std::string& name : names) {
    TRIVET_TRY_ASSIGN(const std::uint32_t found, find_model(library, name));
    wanted.push_back(found);
  }
  for (std::uint32_t m = 0; names.empty() && m < library.models.size(); ++m) wanted.push_back(m);
  std::vector<Exported> models;
  for (const std::uint32_t m : wanted) {
    TRIVET_TRY_ASSIGN(const ModelSurface* const surface, library.surface(m));
    models.push_back({library.models[m], *surface});
  }
  return models;
}

Result<fs::path> write_surface(const Exported& exported, LengthUnit unit, SurfaceFormat format,
                               const fs::path& folder) {
  Cloud cloud;
  cloud.points = Points(PointsView(exported.surface.vertices));
  cloud.triangles = Triangles(TrianglesView(exported.surface.triangles));
  const bool as_ply = format == SurfaceFormat::ply;
  fs::path file = folder / (exported.model.name + (as_ply ? ".ply" : ".glb"));
  TRIVET_TRY(as_ply ? write_ply(file, cloud) : write_glb(file, cloud, unit));
  return file;
}

Result<fs::path> write_data_set(std::span<const Exported> models, LengthUnit unit,
                                const fs::path& folder) {
  std::vector<engine::BopModel> of_bop;
  for (const auto& [model, surface] : models)
    of_bop.push_back({model.name, surface.vertices, surface.triangles, model.symmetry});
  TRIVET_TRY_ASSIGN(std::vector<ManifestModel> entries,
                    engine::write_bop_models(of_bop, unit, unit, folder));
  Manifest manifest;
  manifest.unit = unit;
  manifest.models = std::move(entries);
  fs::path file = folder / "manifest.json";
  TRIVET_TRY(write_manifest(file, manifest));
  return file;
}

}  // namespace

Result<std::vector<fs::path>> export_models(const Library& library,
                                            std::span<const std::string> names,
                                            SurfaceFormat format, const fs::path& folder) {
  TRIVET_TRY_ASSIGN(const std::vector<Exported> models, models_named(library, names));
  TRIVET_TRY(make_folder(folder));
  const LengthUnit unit = library.header.unit;
  std::vector<fs::path> files;
  if (format == SurfaceFormat::bop) {
    TRIVET_TRY_ASSIGN(fs::path file, write_data_set(models, unit, folder));
    files.push_back(std::move(file));
    return files;
  }
  for (const Exported& exported : models) {
    TRIVET_TRY_ASSIGN(fs::path file, write_surface(exported, unit, format, folder));
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace trivet
