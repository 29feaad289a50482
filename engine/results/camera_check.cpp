#include "engine/results/camera_check.hpp"

#include <algorithm>
#include <cmath>

namespace trivet {
namespace {

constexpr double kSurely = 3;  // in standard errors
constexpr double kLeastFocal = 0.015, kLeastDepth = 0.0075;
constexpr std::size_t kFewestObjects = 3;
// Effective number of models by their shares of the information: the second one has about a tenth.
constexpr double kFewestModels = 1.2;

bool is_off(const kernels::Factor& factor, double least) {
  const double away = std::abs(factor.value - 1);
  return away > kSurely * factor.error && away >= least;
}

}  // namespace

bool CameraCheck::focal_is_off() const noexcept {
  return scale && objects.size() >= kFewestObjects && is_off(scale->focal, kLeastFocal);
}

bool CameraCheck::depth_is_off() const noexcept {
  return scale && scale->depth && objects.size() >= kFewestObjects &&
         scale->num_models >= kFewestModels && is_off(*scale->depth, kLeastDepth);
}

std::optional<Camera> corrected_camera(const CameraCheck& check) {
  if (!check.focal_is_off() && !check.depth_is_off()) return std::nullopt;
  Camera camera = check.camera;
  if (check.focal_is_off()) {
    camera.fx *= check.scale->focal.value;
    camera.fy *= check.scale->focal.value;
  }
  if (check.depth_is_off()) camera.depth_scale *= check.scale->depth->value;
  return camera;
}

std::vector<CameraCheck> join_checks(std::span<const CameraCheck> scenes) {
  std::vector<CameraCheck> joined;
  for (const CameraCheck& scene : scenes) {
    auto place = std::ranges::find(joined, scene.camera, &CameraCheck::camera);
    if (place == joined.end()) place = joined.insert(joined.end(), CameraCheck{scene.camera, {}});
    place->objects.insert(place->objects.end(), scene.objects.begin(), scene.objects.end());
    place->num_rays += scene.num_rays;
    place->depth.num_as_said += scene.depth.num_as_said;
    place->depth.num_otherwise += scene.depth.num_otherwise;
    if (scene.depth.curved > place->depth.curved) {
      place->depth.curved = scene.depth.curved;
      place->depth.flat = scene.depth.flat;
    }
  }
  for (CameraCheck& check : joined) {
    if (!check.objects.empty()) check.scale = kernels::estimate_scales(check.objects);
  }
  return joined;
}

}  // namespace trivet
