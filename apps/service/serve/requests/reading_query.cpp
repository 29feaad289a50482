#include "apps/service/serve/requests/reading_query.hpp"

#include <fmt/format.h>

#include "apps/service/http/json_parameters.hpp"

namespace trivet::apps::service {

std::string reading_query(const ManifestScene& scene, LengthUnit unit) {
  std::string extension = scene.file.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::string query = fmt::format("format={}&unit={}", extension, unit_name(unit));
  if (scene.camera) {
    Parameters parameters;
    add_camera(*scene.camera, parameters);
    for (const auto& [name, value] : parameters) query += fmt::format("&{}={}", name, value);
  }
  if (scene.viewpoint) {
    const Eigen::Vector3d& v = *scene.viewpoint;
    query += fmt::format("&viewpoint={},{},{}", v.x(), v.y(), v.z());
  }
  return query;
}

}  // namespace trivet::apps::service
