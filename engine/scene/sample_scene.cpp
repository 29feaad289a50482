#include "engine/scene/sample_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "engine/options/train_options.hpp"
#include "engine/scene/sensor_image.hpp"
#include "engine/scene/thin_by_pixels.hpp"
#include "kernels/surfaces/subsample_by_normals.hpp"
#include "storage/common/clamped_integer.hpp"
#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

// A test of a pose tells shapes apart by five errors, here a fifth of the diameter. Objects that are
// found in real scans are 56 pixels and 75 errors wide, and more.
constexpr float kFewestErrors = 25;
// Normals of points that are a step apart err by a third of a radian where the error that neighbors
// share is a third of the step; a cell of point pairs is 0.2 rad wide. Points that proposed right
// poses in real scans have steps of 4 such errors, and more.
constexpr float kFewestErrorsOfStep = 3;
// Edges are sampled in steps larger by this factor: closer ones found no more in real scans.
constexpr float kEdgeSpacing = 2;
// The same as for models, so that their pairs match.
static_assert(kNormalClusterRad > (kNormalClusterDeg - 0.01F) * std::numbers::pi_v<float> / 180 &&
                  kNormalClusterRad < (kNormalClusterDeg + 0.01F) * std::numbers::pi_v<float> / 180,
              "scenes are thinned as models are");

/// The range up to which an object of a size is shown as many errors of the sensor and as many pixels
/// wide as a test of its pose takes, and points a step apart have normals.
float farthest_shown(const PreparedScene& scene, float diameter, float step) {
  if (scene.view.kind == SceneKind::surface)  // measured from all sides
    return std::numeric_limits<float>::infinity();
  const kernels::SensorModel& sensor = scene.sensor;
  const float correlated = sensor.correlated_noise.height;
  const float growth = std::min(diameter / (kFewestErrors * std::hypot(sensor.noise, correlated)),
                                step / (kFewestErrorsOfStep * correlated));
  return std::min(sensor.range_of_growth(growth),
                  diameter * scene.images.front().geometry.fx / kFewestErrors);
}

/// The points of a cloud up to a range from the sensor: the cloud itself if none is farther away.
///
/// points, normals  storage of the others
OrientedView choose_near(const OrientedView& cloud, const Pose& T_camera_scene, float farthest,
                         Points& points, Normals& normals) {
  const std::size_t n = cloud.points.size();
  std::vector<float> ranges(n);
  StopCheck check_stop(kPixelGrain);
  for (std::size_t i = 0; i < n; ++i) {
    check_stop();
    ranges[i] = (T_camera_scene * cloud.points[i]).z();
  }
  const auto is_far = [&](float range) { return range >= farthest; };
  const auto num_far = std::ranges::count_if(ranges, is_far);
  if (num_far == 0) return cloud;
  points.resize(n - static_cast<std::size_t>(num_far));
  normals.resize(points.size());
  for (std::size_t i = 0, k = 0; i < n; ++i) {
    check_stop();
    if (is_far(ranges[i])) continue;
    points.set(k, cloud.points[i]);
    normals.set(k++, cloud.normals[i]);
  }
  return {points, normals};
}

}  // namespace

SceneSample sample_scene(const PreparedScene& scene, float step, float largest_diameter,
                         LargePlanes large_planes) {
  SceneSample sample;
  sample.step = step;
  sample.largest_diameter = largest_diameter;
  const Pose& T_camera_scene = scene.images.front().geometry.T_camera_scene;
  const float farthest = farthest_shown(scene, largest_diameter, step);
  Points near, points;
  Normals near_normals, normals;
  kernels::SubsampleScratch scratch;
  kernels::subsample_by_normals(
      choose_near({scene.points, scene.normals}, T_camera_scene, farthest, near, near_normals),
      step, kNormalClusterRad, points, normals, scratch);
  check_stop();
  // Means lie on planes more surely than measurements, whose normals are noisy.
  std::vector<std::uint8_t> labels(points.size(), 0);
  if (large_planes == LargePlanes::left_out)
    kernels::label_planes(points, normals, scene.planes, kPlaneAngleRad, labels);
  const std::vector<std::uint8_t> background = background_planes(scene, largest_diameter);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (labels[i] != 0 && background[labels[i] - 1U] != 0) continue;
    sample.points.push_back(points[i]);
    sample.normals.push_back(normals[i]);
  }
  kernels::subsample_by_normals(choose_near({scene.edges, scene.edge_directions}, T_camera_scene,
                                            farthest, near, near_normals),
                                kEdgeSpacing * step, kNormalClusterRad, sample.edges,
                                sample.edge_directions, scratch);
  return sample;
}

bool is_explained(const PreparedScene& scene, std::span<const std::uint8_t> explained,
                  const Eigen::Vector3f& point, float tolerance) {
  std::size_t first = 0;  // first pixel of the image among those of all images
  for (const kernels::RangeImage& image : scene.images) {
    const Eigen::Vector3f p = image.geometry.T_camera_scene * point;
    const std::int64_t pixel = image.geometry.pixel_of(p);
    if (pixel >= 0) {
      const auto at = static_cast<std::size_t>(pixel);
      if (explained[first + at] != 0 && std::abs(image.depth[at] - p.z()) <= tolerance) return true;
    }
    first += image.depth.size();
  }
  return false;
}

SceneLevel choose_voters(const PreparedScene& scene, const SceneSample& sample,
                         const VoteOptions& options, std::span<const std::uint8_t> explained) {
  SceneLevel level;
  level.step = sample.step;
  StopCheck check_stop(kPixelGrain);
  const auto append = [&](const Points& points, const Normals& normals) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      check_stop();
      if (!explained.empty() && is_explained(scene, explained, points[i], sample.step)) continue;
      level.points.push_back(points[i]);
      level.normals.push_back(normals[i]);
    }
  };

  append(sample.points, sample.normals);
  level.references.resize(level.points.size());
  std::iota(level.references.begin(), level.references.end(), 0U);
  const std::size_t num_references =
      clamped_integer(std::ceil(options.reference_share * static_cast<float>(level.points.size())),
                      std::size_t{0}, std::size_t{options.max_references});
  level.references.resize(thin_by_pixels(scene, level.points, num_references, level.references));
  append(sample.edges, sample.edge_directions);
  level.grid =
      kernels::VoxelHash(level.points, std::max(sample.step, 0.25F * sample.largest_diameter));
  return level;
}

}  // namespace trivet::engine
