#include "engine/libraries/export_models.hpp"

#include "engine/common/bop_models.hpp"
#include "engine/libraries/edit_library.hpp"
#include "storage/files/file.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

/// The models with these names, or all models, after checking them.
Result<std::vector<const Model*>> models_named(const Library& library,
                                               std::span<const std::string> names) {
  std::vector<std::uint32_t> wanted;
  for (const std::string& name : names) {
    TRIVET_TRY_ASSIGN(const std::uint32_t found, find_model(library, name));
    wanted.push_back(found);
  }
  for (std::uint32_t m = 0; names.empty() && m < library.models.size(); ++m) wanted.push_back(m);
  std::vector<const Model*> models;
  for (const std::uint32_t m : wanted) {
    TRIVET_TRY(library.check(m, ModelPart::surface));
    models.push_back(&library.models[m]);
  }
  return models;
}

Result<fs::path> write_surface(const Model& model, LengthUnit unit, SurfaceFormat format,
                               const fs::path& folder) {
  Cloud cloud;
  cloud.points = Points(PointsView(model.vertices));
  cloud.triangles = Triangles(TrianglesView(model.triangles));
  const bool as_ply = format == SurfaceFormat::ply;
  fs::path file = folder / (model.name + (as_ply ? ".ply" : ".glb"));
  TRIVET_TRY(as_ply ? write_ply(file, cloud) : write_glb(file, cloud, unit));
  return file;
}

Result<fs::path> write_data_set(std::span<const Model* const> models, LengthUnit unit,
                                const fs::path& folder) {
  std::vector<engine::BopModel> of_bop;
  for (const Model* model : models)
    of_bop.push_back({model->name, model->vertices, model->triangles, model->symmetry});
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
  TRIVET_TRY_ASSIGN(const std::vector<const Model*> models, models_named(library, names));
  TRIVET_TRY(make_folder(folder));
  const LengthUnit unit = library.header.unit;
  std::vector<fs::path> files;
  if (format == SurfaceFormat::bop) {
    TRIVET_TRY_ASSIGN(fs::path file, write_data_set(models, unit, folder));
    files.push_back(std::move(file));
    return files;
  }
  for (const Model* model : models) {
    TRIVET_TRY_ASSIGN(fs::path file, write_surface(*model, unit, format, folder));
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace trivet
