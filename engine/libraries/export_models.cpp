#include "engine/libraries/export_models.hpp"

#include "engine/libraries/edit_library.hpp"
#include "storage/file.hpp"
#include "storage/read_cloud.hpp"

namespace trivet {
namespace {

Cloud surface_of(const Model& model) {
  Cloud cloud;
  cloud.points = Points(PointsView(model.vertices));
  cloud.triangles = Triangles(TrianglesView(model.triangles));
  return cloud;
}

}  // namespace

Result<std::vector<std::filesystem::path>> export_models(const Library& library,
                                                         std::span<const std::string> names,
                                                         const std::filesystem::path& folder) {
  std::vector<std::uint32_t> wanted;
  for (const std::string& name : names) {
    const Result<std::uint32_t> found = find_model(library, name);
    if (!found) return found.error();
    wanted.push_back(*found);
  }
  for (std::uint32_t m = 0; names.empty() && m < library.models.size(); ++m) wanted.push_back(m);
  if (const Result<void> made = make_folder(folder); !made) return made.error();
  std::vector<std::filesystem::path> files;
  for (const std::uint32_t m : wanted) {
    if (const Result<void> good = library.check(m, ModelPart::surface); !good) return good.error();
    const Model& model = library.models[m];
    files.push_back(folder / (model.name + ".ply"));
    if (const Result<void> written = write_ply(files.back(), surface_of(model)); !written)
      return written.error();
  }
  return files;
}

}  // namespace trivet
