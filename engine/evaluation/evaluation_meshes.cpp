#include "engine/evaluation/evaluation_meshes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "engine/common/parallel.hpp"
#include "engine/common/scaled.hpp"
#include "kernels/surfaces/diameter.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

Result<EvaluationMesh> read_mesh(const ManifestModel& model, LengthUnit unit) {
  const std::filesystem::path& file = model.eval_file.empty() ? model.file : model.eval_file;
  TRIVET_TRY_ASSIGN(Cloud cloud, read_cloud(file, {.unit = unit, .keep_origin = true}));
  EvaluationMesh mesh;
  mesh.name = model.name;
  mesh.vertices = engine::scaled_points(cloud.points, model.scale);
  mesh.triangles = std::move(cloud.triangles);
  mesh.diameter =
      model.diameter ? *model.diameter : static_cast<double>(kernels::find_diameter(mesh.vertices));
  if (model.symmetry) mesh.symmetry = *model.symmetry;
  if (!(mesh.diameter > 0)) {
    return Error{
        ErrorCode::bad_data,
        fmt::format("{}: model '{}': expected vertices that lie apart, found {} in one place; "
                    "name a file with the model's surface",
                    file.string(), model.name, mesh.vertices.size())};
  }
  return mesh;
}

}  // namespace

Result<std::vector<EvaluationMesh>> read_evaluation_meshes(const Manifest& manifest) {
  std::vector<std::optional<Result<EvaluationMesh>>> read(manifest.models.size());
  engine::for_each_index(
      read.size(), [&](std::size_t i) { read[i] = read_mesh(manifest.models[i], manifest.unit); });
  std::vector<EvaluationMesh> meshes;
  for (std::optional<Result<EvaluationMesh>>& mesh : read) {
    if (!*mesh) return mesh->error();
    meshes.push_back(std::move(**mesh));
  }
  return meshes;
}

Result<std::vector<EvaluationMesh>> meshes_of(const Library& library) {
  std::vector<EvaluationMesh> meshes;
  for (std::uint32_t m = 0; m < library.models.size(); ++m) {
    TRIVET_TRY_ASSIGN(const ModelSurface* const surface, library.surface(m));
    const ModelInfo& model = library.models[m];
    meshes.push_back({model.name, surface->vertices, surface->triangles,
                      static_cast<double>(model.diameter), model.symmetry});
  }
  return meshes;
}

const EvaluationMesh* find_mesh(std::span<const EvaluationMesh> meshes, std::string_view name) {
  const auto found = std::find_if(meshes.begin(), meshes.end(),
                                  [&](const EvaluationMesh& mesh) { return mesh.name == name; });
  return found == meshes.end() ? nullptr : &*found;
}

}  // namespace trivet
