#include "engine/recognition/recognize.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>
#include <vector>

#include "engine/camera/check_camera.hpp"
#include "engine/camera/check_depth_kind.hpp"
#include "engine/recognition/report.hpp"
#include "engine/recognition/search_plan.hpp"
#include "engine/recognition/search_scene.hpp"
#include "engine/results/stage_times.hpp"
#include "kernels/common/median.hpp"
#include "storage/common/stop.hpp"
#include "storage/formats/keep_points.hpp"

namespace trivet {
namespace {

using engine::PreparedScene;

bool is_place(const Eigen::Vector3d& v) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kMaxCoordinate;
}

/// Extent along the axes; zeros without points.
Eigen::Vector3f size_of(PointsView points) {
  if (points.size() == 0) return Eigen::Vector3f::Zero();
  Eigen::Array3f low = points[0].array(), high = low;
  for (std::size_t i = 1; i < points.size(); ++i) {
    low = low.min(points[i].array());
    high = high.max(points[i].array());
  }
  return (high - low).matrix();
}

/// Distance from a place to the nearest of the points.
double nearest_distance(PointsView points, const Eigen::Vector3d& place) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i)
    nearest = std::min(nearest, (points[i].cast<double>() - place).norm());
  return nearest;
}

/// The explained place without its models.
///
/// point  place in the frame and unit of the scene's file
PlaceExplanation explained_place(const Eigen::Vector3d& point, const Cloud& cloud) {
  return {point, nearest_distance(cloud.points, point - cloud.offset), {}};
}

/// Maximum size of a scene, in diameters of the library's largest model.
constexpr float kLargestScene = 500;
/// Maximum share of points beyond that size. Sensors report such points where there is no surface.
constexpr double kMostStray = 0.01;

/// Remove points farther than half of the maximum scene size from the median point, if they are
/// few.
///
/// radius  half of the maximum scene size [cloud's unit]
/// Returns the cloud without them. Absent if there are no such points, or too many.
std::optional<Cloud> without_stray_points(const Cloud& cloud, float radius) {
  const std::size_t n = cloud.points.size();
  const PointsView points = cloud.points;
  Eigen::Vector3f middle;
  for (const auto& [axis, column] : {std::pair(0, points.x), {1, points.y}, {2, points.z}}) {
    Column<float> values(column.begin(), column.end());
    middle[axis] = kernels::median(std::span(values));
  }
  std::vector<std::uint8_t> keep(n);
  std::size_t num_stray = 0;
  for (std::size_t i = 0; i < n; ++i) {
    keep[i] = (points[i] - middle).norm() <= radius;
    num_stray += keep[i] == 0;
  }
  if (num_stray == 0 || static_cast<double>(num_stray) > kMostStray * static_cast<double>(n))
    return std::nullopt;
  Cloud kept = cloud;
  keep_points(keep, kept);
  return kept;
}

/// Reject a scene whose size shows that its unit differs from the library's; stray points are left
/// out.
///
/// stray  receives the cloud without stray points, if there were any
Result<void> check_sizes(const Library& library, const Cloud& cloud, const SceneInput& input,
                         std::optional<Cloud>& stray) {
  const auto scale = static_cast<float>(input.scale);
  const float extent = scale * size_of(cloud.points).norm();
  float smallest = std::numeric_limits<float>::infinity(), largest = 0;
  for (const ModelInfo& model : library.models) {
    smallest = std::min(smallest, model.diameter);
    largest = std::max(largest, model.diameter);
  }
  if (extent > kLargestScene * largest) {
    stray = without_stray_points(cloud, kLargestScene / 2 * largest / scale);
    if (stray) return {};
  } else if (extent >= 0.05F * smallest) {
    return {};
  }
  return Error{
      ErrorCode::bad_data,
      fmt::format("{}: expected a scene about as large as the models (diameters {:.4g} to "
                  "{:.4g} {}), found "
                  "an extent of {:.4g}; if the scene's unit differs, give --unit",
                  input.file.string(), smallest, largest, unit_name(library.header.unit), extent)};
}

/// Reject a viewpoint that lies among the points but would lie in front of them if it were a
/// thousand times as far away. It was then given in meters while the scene is in millimeters.
Result<void> check_viewpoint(const Cloud& cloud, const SceneInput& input) {
  constexpr double kMillimeters = 1000;
  if (!input.viewpoint || input.viewpoint->isZero(0) || !cloud.offset.isZero(0)) return {};
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) box.extend(cloud.points[i].cast<double>());
  const Eigen::Vector3d& eye = *input.viewpoint;
  const double size = box.diagonal().norm(), meant = (kMillimeters * eye).norm();
  const bool is_meant =
      meant > size / 2 && meant < 20 * size && !box.contains((kMillimeters * eye).eval());
  if (!box.contains(eye) || !(eye.norm() < 0.02 * size) || !is_meant) return {};
  return Error{
      ErrorCode::bad_data,
      fmt::format(
          "{}: expected the viewpoint ({:.4g}, {:.4g}, {:.4g}) in the scene's unit, found it "
          "among the points, whose extent is {:.4g}; it looks as if it were in meters and "
          "the scene in millimeters",
          input.file.string(), eye.x(), eye.y(), eye.z(), size)};
}

/// Like recognize, for a library that does not change meanwhile.
Result<SceneResult> recognize_in(const Recognizer& recognizer, const Cloud& scan,
                                 const SceneInput& input, const RecognizeOptions& asked,
                                 const std::stop_token& stop) try {
  const StopScope scope(&stop);
  TRIVET_TRY(validate(asked));
  if (input.viewpoint && !is_place(*input.viewpoint))
    return Error{ErrorCode::usage, "viewpoint: expected three numbers of at most 1e10"};
  const Library& library = recognizer.library();
  const Result<engine::SearchPlan> plan = engine::plan_search(asked, library, scan.offset);
  if (!plan) return plan.error();

  std::optional<Cloud> without_stray;
  const bool is_large_enough =
      scan.points.size() >= engine::kFewestPoints || !scan.triangles.empty();
  if (is_large_enough) {
    TRIVET_TRY(check_sizes(library, scan, input, without_stray));
    TRIVET_TRY(check_viewpoint(scan, input));
  }
  const Cloud& cloud = without_stray ? *without_stray : scan;

  SceneStats stats;
  stats.num_stray = scan.points.size() - cloud.points.size();
  stats.num_points = cloud.points.size();
  stats.num_invalid = cloud.num_invalid;
  stats.size = size_of(cloud.points);
  if (!is_large_enough) {
    SceneResult nothing;
    nothing.offset = cloud.offset;
    nothing.stats = std::move(stats);
    if (asked.explain.point) nothing.explanation = explained_place(*asked.explain.point, cloud);
    return nothing;
  }

  const auto start = std::chrono::steady_clock::now();
  Result<PreparedScene> scene = engine::prepare_scene(cloud, input, stats.times, plan->prepare);
  if (!scene) return scene.error();
  const Result<engine::SearchResult> found = engine::search_scene(recognizer, *scene, *plan, stats);
  recognizer.release_memory();
  if (!found) return found.error();
  if (cloud.camera && scene->view.kind == SceneKind::image) {
    const StageTimer timer(stats.times, "check camera");
    stats.camera_check =
        engine::check_camera(recognizer, *scene, *cloud.camera, found->poses, found->detections);
    stats.camera_check->depth = engine::check_depth_kind(*scene, *cloud.camera);
  }
  SceneResult result = engine::report(library, *scene, *found, std::move(stats));
  if (result.explanation) {
    PlaceExplanation place = explained_place(*asked.explain.point, cloud);
    place.models = std::move(result.explanation->models);
    result.explanation = std::move(place);
  }
  if (asked.max_sigma) {
    for (Detection& detection : result.detections)
      detection.is_uncertain = kernels::largest_shift(detection.covariance) > *asked.max_sigma;
  }
  result.offset = cloud.offset;
  result.stats.total_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
} catch (const Stopped&) {
  return Error{ErrorCode::resumable, "stopped on request"};
}

}  // namespace

Result<SceneResult> recognize(const Recognizer& recognizer, const Cloud& cloud,
                              const SceneInput& input, const RecognizeOptions& asked,
                              std::stop_token stop) {  // NOLINT: the caller may give it away
  const Library& library = recognizer.library();
  TRIVET_TRY(library.unchanged());
  // If the mapped file was changed meanwhile, neither a result nor an exception is a valid answer.
  try {
    Result<SceneResult> result = recognize_in(recognizer, cloud, input, asked, stop);
    TRIVET_TRY(library.unchanged());
    return result;
  } catch (const std::exception&) {
    TRIVET_TRY(library.unchanged());
    throw;
  }
}

}  // namespace trivet
