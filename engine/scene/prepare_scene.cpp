#include "engine/scene/prepare_scene.hpp"

#include <optional>
#include <utility>

#include "engine/common/check_extent.hpp"
#include "engine/scene/find_view.hpp"
#include "engine/scene/prepare_closed_scene.hpp"
#include "engine/scene/prepare_sensor_scene.hpp"
#include "storage/common/stop.hpp"
#include "storage/formats/keep_points.hpp"
#include "storage/formats/used_vertices.hpp"

namespace trivet::engine {
namespace {

/// Choose the faces of a closed scene; points on none of them are removed.
Triangles choose_faces(const Cloud& cloud, PreparedScene& scene) {
  const UsedVertices used = find_used_vertices(scene.points, cloud.triangles);
  if (used.num_unused == 0 || used.num_unused == scene.points.size()) return cloud.triangles;
  Cloud surface;
  surface.points = std::move(scene.points);
  surface.triangles = cloud.triangles;
  keep_points(used.marks, surface);
  scene.points = std::move(surface.points);
  return std::move(surface.triangles);
}

}  // namespace

Result<PreparedScene> prepare_scene(const Cloud& cloud, const SceneInput& input, StageTimes& times,
                                    const PrepareOptions& options) {
  const StageTimer timer(times, "prepare");
  check_stop();
  PreparedScene scene;
  scene.points = cloud.points;
  check_stop();
  scene.scale = input.scale;
  scene.offset = cloud.offset;
  if (input.scale != 1) {
    const PointsSpan span = scene.points;
    const auto scale = static_cast<float>(input.scale);
    for (const std::span<float> column : {span.x, span.y, span.z}) {
      for (float& value : column) value *= scale;
    }
  }
  TRIVET_TRY_ASSIGN(FoundView found, find_view(cloud, input));
  scene.view = found.view;
  if (found.geometry)
    found.geometry->T_camera_scene.translation() *= static_cast<float>(input.scale);
  const bool closed = scene.view.kind == SceneKind::surface;
  if (!closed && cloud.points.size() < kFewestPoints) {
    return too_few_points(input, "", cloud.points.size());
  }
  TRIVET_TRY(check_extent(scene.points, input.file.string()));
  TRIVET_TRY(closed ? prepare_closed_scene(choose_faces(cloud, scene), input, options, scene)
                    : prepare_sensor_scene(cloud, found.geometry, input, options, scene));
  return scene;
}

std::vector<std::uint8_t> background_planes(const PreparedScene& scene, float diameter) {
  std::vector<std::uint8_t> background;
  for (const float area : scene.patches) background.push_back(area > 0.8F * diameter * diameter);
  return background;
}

}  // namespace trivet::engine
