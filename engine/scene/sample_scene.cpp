#include "engine/scene/sample_scene.hpp"

#include <algorithm>
#include <cmath>
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

/// Whether an object of a size would be shown at a point as many errors of the sensor and as many
/// pixels wide as a test of its pose takes, and whether points a step apart have normals.
bool shows(const PreparedScene& scene, const Eigen::Vector3f& point, float diameter, float step) {
  if (scene.view.kind == SceneKind::surface) return true;  // measured from all sides
  const kernels::ImageGeometry& geometry = scene.images.front().geometry;
  const float range = (geometry.T_camera_scene * point).z();
  return diameter > kFewestErrors * scene.sensor.error_at(range) &&
         step > kFewestErrorsOfStep * scene.sensor.correlated_noise_at(range).height &&
         diameter * geometry.fx > kFewestErrors * range;
}

}  // namespace

SceneSample sample_scene(const PreparedScene& scene, float step, float largest_diameter,
                         LargePlanes large_planes) {
  SceneSample sample;
  sample.step = step;
  sample.largest_diameter = largest_diameter;
  Points points;
  Normals normals;
  kernels::SubsampleScratch scratch;
  kernels::subsample_by_normals({scene.points, scene.normals}, step, kNormalClusterRad, points,
                                normals, scratch);
  check_stop();
  std::vector<std::uint8_t> labels(points.size(), 0);
  if (large_planes == LargePlanes::left_out)
    kernels::label_planes(points, normals, scene.planes, kPlaneAngleRad, labels);
  const std::vector<std::uint8_t> background = background_planes(scene, largest_diameter);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (labels[i] != 0 && background[labels[i] - 1U] != 0) continue;
    if (!shows(scene, points[i], largest_diameter, step)) continue;
    sample.points.push_back(points[i]);
    sample.normals.push_back(normals[i]);
  }
  kernels::subsample_by_normals({scene.edges, scene.edge_directions}, kEdgeSpacing * step,
                                kNormalClusterRad, points, normals, scratch);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!shows(scene, points[i], largest_diameter, step)) continue;
    sample.edges.push_back(points[i]);
    sample.edge_directions.push_back(normals[i]);
  }
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
