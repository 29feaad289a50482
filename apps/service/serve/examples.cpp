#include "apps/service/serve/examples.hpp"

#include <fmt/format.h>

#include "apps/inputs/inputs.hpp"

namespace trivet::apps::service {

Result<std::vector<Example>> list_examples(const std::string& listing) {
  const Result<Manifest> manifest = read_listing(listing);
  if (!manifest) return manifest.error();
  std::vector<Example> examples;
  for (const ManifestScene& scene : manifest->scenes) {
    std::string extension = scene.file.extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    std::string query = fmt::format("format={}&unit={}", extension, unit_name(manifest->unit));
    if (scene.camera) {
      const Camera& c = *scene.camera;
      query += fmt::format("&camera={},{},{},{},{}", c.fx, c.fy, c.cx, c.cy, c.depth_scale);
    }
    if (scene.viewpoint) {
      const Eigen::Vector3d& v = *scene.viewpoint;
      query += fmt::format("&viewpoint={},{},{}", v.x(), v.y(), v.z());
    }
    examples.push_back({scene.name, scene.file, std::move(query)});
  }
  return examples;
}

}  // namespace trivet::apps::service
