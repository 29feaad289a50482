#include "engine/common/bop_models.hpp"

#include <Eigen/Geometry>

#include "engine/common/scaled.hpp"
#include "kernels/surfaces/diameter.hpp"
#include "storage/datasets/write_bop.hpp"
#include "storage/files/file.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::engine {

Result<std::vector<ManifestModel>> write_bop_models(std::span<const BopModel> models,
                                                    LengthUnit unit, LengthUnit manifest_unit,
                                                    const std::filesystem::path& folder,
                                                    std::initializer_list<const char*> further) {
  std::vector<std::filesystem::path> folders{folder / "models"};
  for (const char* name : further) folders.push_back(folder / name);
  for (const auto& place : folders) {
    TRIVET_TRY(make_folder(place));
  }
  const double to_mm = unit_scale(unit, LengthUnit::millimeter);
  std::vector<ManifestModel> entries;
  std::vector<BopObject> objects;
  for (const BopModel& model : models) {
    const int id = static_cast<int>(entries.size()) + 1;
    const std::string name = bop_model_name(id) + ".ply";
    Cloud surface;
    surface.points = scaled_points(model.vertices, to_mm);
    surface.triangles = Triangles(model.triangles);
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < surface.points.size(); ++i)
      box.extend(surface.points[i].cast<double>());
    for (const auto& place : folders) {
      TRIVET_TRY(write_ply(place / name, surface));
    }
    objects.push_back({id, static_cast<double>(kernels::find_diameter(surface.points)), box.min(),
                       box.sizes(), scaled(model.symmetry, to_mm)});
    ManifestModel entry;
    entry.name = model.name;
    entry.file = folders[0] / name;
    entry.scale = unit_scale(LengthUnit::millimeter, manifest_unit);
    if (!model.symmetry.trivial())
      entry.symmetry = scaled(model.symmetry, unit_scale(unit, manifest_unit));
    entry.object_id = id;
    entries.push_back(std::move(entry));
  }
  for (const auto& place : folders) {
    TRIVET_TRY(write_bop_models_info(place / "models_info.json", objects));
  }
  return entries;
}

}  // namespace trivet::engine
