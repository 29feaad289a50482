#include "engine/scene/prepare_sensor_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/common/parallel.hpp"
#include "engine/scene/measure_sensor.hpp"
#include "engine/scene/sensor_image.hpp"
#include "kernels/common/median.hpp"
#include "kernels/scans/depth_quantization.hpp"
#include "kernels/scans/estimate_normals_grid.hpp"
#include "kernels/scans/ground_planes.hpp"
#include "kernels/scans/merge_pixels.hpp"
#include "kernels/scans/occluding_edges.hpp"
#include "kernels/scans/plane_patches.hpp"
#include "kernels/scans/plane_samples.hpp"
#include "kernels/scans/sparse_grid.hpp"
#include "storage/common/clamped_integer.hpp"
#include "storage/common/stop.hpp"
#include "storage/data/file_pose.hpp"

namespace trivet::engine {
namespace {

constexpr float kDithers = 0.7F;  // of the error of a step: more noise varies what step is measured
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Half-width of the windows that normals are fitted to [pixel].
std::uint32_t window_of(const PreparedScene& scene) {
  return clamped_integer(std::round(scene.window), 1U, kernels::GridNormalOptions::kMaxWindow);
}

/// recovered  geometry that the grid or the rays of the points determine
/// points     points of the cloud; scattered ones are merged by pixel
std::optional<SensorView> find_sensor(const Cloud& cloud,
                                      const std::optional<kernels::ImageGeometry>& recovered,
                                      const Eigen::Vector3f& viewpoint, Points& points) {
  const bool is_image = cloud.grid && !kernels::is_sparse(*cloud.grid);
  if (cloud.camera && is_image) {
    if (std::max(cloud.camera->fx, cloud.camera->fy) > kernels::kLargestFocalLength)
      return std::nullopt;
    return SensorView{kernels::geometry_of(*cloud.camera, *cloud.grid), *cloud.grid, false};
  }
  if (recovered && is_image) return SensorView{*recovered, *cloud.grid, false};
  const bool is_listed = recovered && !cloud.grid;  // the pixels of an image as a list of points
  const std::optional<kernels::ImageGeometry> geometry =
      is_listed ? recovered : kernels::choose_camera(points, viewpoint);
  if (!geometry) return std::nullopt;
  kernels::MergedPixels merged = kernels::merge_pixels(*geometry, points);
  points = std::move(merged.points);
  return SensorView{*geometry, std::move(merged.grid), !is_listed};
}

/// planes  planes in the camera's frame
void label_pixels(std::span<const kernels::Plane> planes, kernels::RangeImage& image) {
  const kernels::ImageGeometry& geometry = image.geometry;
  PerThread<Points> points([&] { return Points(geometry.width); });
  for_each_index(geometry.height, [&](std::size_t v) {
    Points& at = points.local();
    for (std::size_t u = 0; u < geometry.width; ++u) {
      const std::size_t pixel = v * geometry.width + u;
      at.set(u, image.depth[pixel] > 0 ? geometry.back_project(pixel, image.depth[pixel])
                                       : Eigen::Vector3f::Constant(kNaN));
    }
    const std::size_t row = v * geometry.width;
    kernels::label_planes(at, image.normals.view().slice(row, geometry.width), planes,
                          kPlaneAngleRad, std::span(image.plane).subspan(row, geometry.width));
    kernels::label_planes(at, planes, std::span(image.near_plane).subspan(row, geometry.width));
  });
}

void find_dominant_planes(kernels::RangeImage& image, const PrepareOptions& options,
                          PreparedScene& scene) {
  const kernels::PlaneSamples samples = kernels::sample_for_planes(image);
  if (samples.points.size() < 100) return;
  kernels::PlaneOptions plane_options;
  plane_options.tolerance = std::max(4 * scene.sensor.noise, 3 * scene.spacing);
  plane_options.noise = scene.sensor.noise;
  plane_options.min_area = 0.01F * samples.total_area;  // walls of a bin on a large table
  plane_options.max_planes = 8;  // table, floor and four walls of a bin, and two more
  scene.planes =
      kernels::find_planes(samples.points, samples.normals, samples.areas, plane_options);
  label_pixels(scene.planes, image);
  scene.patches = kernels::largest_patches(image, scene.planes);
  const std::size_t window = 2 * std::size_t{window_of(scene)} + 1;
  // Sensors that match windows measure wrong depths in patches as large as a window.
  scene.ground = kernels::find_ground(image, scene.planes, window * window + 1);
  if (options.correlated_noise)
    scene.sensor.correlated_noise = kernels::measure_correlated_noise(image, scene.planes, window);

  // Planes of the image are in the camera's frame, those of the scene in its own.
  const Pose T_scene_camera = image.geometry.T_camera_scene.inverse();
  for (kernels::Plane& plane : scene.planes) {
    const Eigen::Vector3f n = T_scene_camera.linear() * plane.normal;
    plane.offset += n.dot(T_scene_camera.translation());
    plane.normal = n;
  }
}

void find_edges(PreparedScene& scene) {
  const kernels::RangeImage& image = scene.images.front();
  const std::size_t height = image.geometry.height;
  float nearest = std::numeric_limits<float>::infinity();
  for (const float d : image.depth) nearest = d > 0 ? std::min(nearest, d) : nearest;
  const kernels::OccludingEdgeOptions options{scene.sensor, nearest,
                                              static_cast<int>(window_of(scene))};
  struct Edges {
    Points points;
    Normals directions;
  };
  std::vector<Edges> rows((height + kRowGrain - 1) / kRowGrain);
  for_each_index(rows.size(), [&](std::size_t k) {
    const std::size_t first = k * kRowGrain;
    kernels::find_occluding_edges(image, options, first, std::min(kRowGrain, height - first),
                                  rows[k].points, rows[k].directions);
  });
  const Pose T_scene_camera = image.geometry.T_camera_scene.inverse();
  for (const Edges& row : rows) {
    for (std::size_t i = 0; i < row.points.size(); ++i) {
      scene.edges.push_back(T_scene_camera * row.points[i]);
      scene.edge_directions.push_back(T_scene_camera.linear() * row.directions[i]);
    }
  }
}

}  // namespace

Error too_few_points(const SceneInput& input, std::string_view which, std::size_t num_points) {
  return {ErrorCode::bad_data, fmt::format("{}: expected a scan of at least {} points{}, found {}",
                                           input.file.string(), kFewestPoints, which, num_points)};
}

Result<void> prepare_sensor_scene(const Cloud& cloud,
                                  const std::optional<kernels::ImageGeometry>& recovered,
                                  const SceneInput& input, const PrepareOptions& options,
                                  PreparedScene& scene) {
  const Eigen::Vector3f viewpoint =
      in_cloud_frame(*scene.view.viewpoint, cloud.offset) * static_cast<float>(input.scale);
  const auto no_visible_points = [&] {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected a scan seen from the viewpoint ({}, {}, {}), found {} "
                             "points that no camera "
                             "there can see; give the sensor's position with --viewpoint",
                             input.file.string(), viewpoint.x(), viewpoint.y(), viewpoint.z(),
                             cloud.points.size())};
  };
  const std::optional<SensorView> view = find_sensor(cloud, recovered, viewpoint, scene.points);
  if (!view) return no_visible_points();
  scene.view.kind = view->scattered ? SceneKind::points : SceneKind::image;
  if (scene.points.size() < kFewestPoints)
    return too_few_points(input, " in different directions", scene.points.size());
  const kernels::ImageGeometry& geometry = view->geometry;

  Column<float> footprints, depths;
  for (std::size_t i = 0; i < scene.points.size(); i += 1 + scene.points.size() / 20000) {
    depths.push_back((geometry.T_camera_scene * scene.points[i]).z());
    footprints.push_back(depths.back() / geometry.fx);
  }
  scene.spacing = kernels::median(std::span(footprints));
  if (!(scene.spacing > 0)) return no_visible_points();  // most points lie behind the sensor

  kernels::PixelPoints pixels;
  kernels::arrange_pixels(view->grid, scene.points, pixels);
  scene.normals.resize(scene.points.size());
  std::fill(scene.normals.span().x.begin(), scene.normals.span().x.end(), kNaN);
  Column<float> residuals(scene.points.size(), kNaN);
  const auto estimate = [&](std::uint32_t window) {
    kernels::GridNormalOptions window_options;
    window_options.window = window;
    for_chunks(geometry.height, kRowGrain, [&](std::size_t first, std::size_t count) {
      kernels::estimate_normals_grid({view->grid, pixels, viewpoint}, window_options, first, count,
                                     scene.normals, residuals);
    });
  };
  estimate(kNoiseWindow);
  check_stop();
  Column<float> scratch;
  scene.sensor.noise = kernels::estimate_scan_noise(residuals, scratch);
  // Noise that is not far below a step of depth shows the step's error, too. Else surfaces have no
  // residuals within a step, and do not tell how far off depth is.
  const float step_error = kernels::quantization_error(kernels::quantization_step(depths));
  if (scene.sensor.noise < kDithers * step_error) scene.sensor.noise = step_error;
  scene.window = options.normal_window.value_or(choose_window(scene.sensor.noise, scene.spacing));
  const std::uint32_t window = window_of(scene);
  if (window != kNoiseWindow) estimate(window);

  scene.images.push_back(make_image(*view, {scene.points, scene.normals}));
  if (view->scattered) close_holes(3 * scene.spacing, scene.images.back());
  find_dominant_planes(scene.images.back(), options, scene);
  measure_sensor(scene.images.back(), options, scene.sensor);
  find_edges(scene);
  return {};
}

}  // namespace trivet::engine
