#include "engine/camera/check_camera.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/common/parallel.hpp"
#include "engine/verification/pose_tester.hpp"
#include "kernels/verification/object_scale.hpp"

namespace trivet::engine {
namespace {

constexpr float kSureScore = 0.9F;
constexpr int kSteps = 3;  // iterations; scales and poses start near the solution
constexpr std::size_t kFewestRays = 40;
// In units of the full test's tolerance, since wrong scales leave larger residuals.
constexpr float kGate = 1.5F;
constexpr float kFinest = 1e-4F;  // minimum noise, as a share of the range
// Edges are displaced inward, but without them almost nothing of small objects would remain.
constexpr float kLeastEdge = 2, kMostEdge = 3;  // [pixel]
constexpr double kFarthest = 0.2;  // log scales beyond this limit cannot be calibration errors

struct SureObject {
  std::uint32_t model = 0;
  Pose T_camera_model;
  kernels::ScaleOptions options;
  kernels::ObjectEquations equations{};

  bool has_enough_rays() const noexcept { return equations.num_used >= kFewestRays; }
};

std::vector<SureObject> sure_objects(const Library& library, const PreparedScene& scene,
                                     const PoseTable& poses, std::span<const Row> detections) {
  std::vector<SureObject> objects;
  const Pose& T_camera_scene = scene.images.front().geometry.T_camera_scene;
  for (const Row row : detections) {
    if (poses.score[row] < kSureScore || !poses.ambiguity(row).alternatives.empty()) continue;
    const Pose pose = T_camera_scene * poses.T_scene_model[row];
    const float range = (pose * library.models[poses.model[row]].center).z();
    kernels::ScaleOptions options;
    options.sigma = std::max(scene.sensor.error_at(range), kFinest * range);
    options.gate = kGate * poses.test(row).largest_tolerance;
    options.edge_pixels = static_cast<int>(
        std::lround(std::clamp(scene.sensor.edge_pixels(), kLeastEdge, kMostEdge)));
    objects.push_back({poses.model[row], pose, options});
  }
  return objects;
}

/// Set up the equations of all objects. An object that cannot be traced is left out.
void gather(const Recognizer& recognizer, const kernels::RangeImage& image,
            const kernels::LogScales& scales, std::span<SureObject> objects) {
  PerThread<kernels::ScaleScratch> scratch;
  for_each_index(objects.size(), [&](std::size_t k) {
    SureObject& object = objects[k];
    const auto surface = recognizer.surface(object.model);
    const Result<TestedModel> model = tested_model(recognizer.library(), object.model);
    if (!surface || !model) return;
    kernels::gather_object(image, {**surface, model->samples, object.T_camera_model}, scales,
                           object.options, scratch.local(), object.equations);
  });
}

}  // namespace

CameraCheck check_camera(const Recognizer& recognizer, const PreparedScene& scene,
                         const Camera& camera, const PoseTable& poses,
                         std::span<const Row> detections) {
  CameraCheck check{camera, {}};
  // A filter moves surfaces by more than a slightly wrong camera does.
  if (scene.sensor.smoothing > 0) return check;
  std::vector<SureObject> objects = sure_objects(recognizer.library(), scene, poses, detections);
  kernels::LogScales scales;
  for (int step = 0; step <= kSteps; ++step) {
    gather(recognizer, scene.images.front(), scales, objects);
    check.objects.clear();
    for (const SureObject& object : objects) {
      check.num_rays += object.equations.num_rays;
      if (!object.has_enough_rays()) continue;
      check.objects.push_back(kernels::leave_pose_free(object.equations, scales));
      check.objects.back().model = object.model;
      check.objects.back().correlation = scene.sensor.correlation;
    }
    if (check.objects.empty()) break;
    check.scale = kernels::estimate_scales(check.objects);
    const kernels::LogScales now{std::log(check.scale->focal.value),
                                 check.scale->depth ? std::log(check.scale->depth->value) : 0};
    if (std::max(std::abs(now.focal), std::abs(now.depth)) > kFarthest) {
      check.objects.clear();
      break;
    }
    const kernels::LogScales change{now.focal - scales.focal, now.depth - scales.depth};
    for (SureObject& object : objects) {
      if (!object.has_enough_rays()) continue;
      object.T_camera_model =
          kernels::follow_scales(object.equations, change, object.T_camera_model,
                                 recognizer.library().models[object.model].center);
    }
    scales = now;
  }
  if (check.objects.empty()) check.scale.reset();
  return check;
}

}  // namespace trivet::engine
