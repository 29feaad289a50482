#include "engine/scene/prepare_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include "engine/common/check_extent.hpp"
#include "engine/common/parallel.hpp"
#include "engine/options/train_options.hpp"
#include "engine/scene/find_view.hpp"
#include "engine/scene/thin_by_pixels.hpp"
#include "kernels/common/median.hpp"
#include "kernels/scans/estimate_normals_grid.hpp"
#include "kernels/scans/ground_planes.hpp"
#include "kernels/scans/merge_pixels.hpp"
#include "kernels/scans/plane_patches.hpp"
#include "kernels/scans/plane_samples.hpp"
#include "kernels/scans/sparse_grid.hpp"
#include "kernels/surfaces/estimate_normals.hpp"
#include "kernels/surfaces/sample_mesh.hpp"
#include "kernels/surfaces/subsample_by_normals.hpp"
#include "storage/common/clamped_integer.hpp"
#include "storage/common/counted.hpp"
#include "storage/common/stop.hpp"
#include "storage/data/bounding_box.hpp"
#include "storage/data/file_pose.hpp"
#include "storage/formats/keep_points.hpp"
#include "storage/formats/used_vertices.hpp"

namespace trivet::engine {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kRowGrain = 8;          // image rows per task
constexpr std::size_t kPixelGrain = 1 << 16;  // pixels per task with little work per pixel
// A test of a pose tells shapes apart by five errors, here a fifth of the diameter. Objects that are
// found in real scans are 56 pixels and 75 errors wide, and more.
constexpr float kFewestErrors = 25;
// Normals of points that are a step apart err by a third of a radian where the error that neighbors
// share is a third of the step; a cell of point pairs is 0.2 rad wide. Points that proposed right
// poses in real scans have steps of 4 such errors, and more.
constexpr float kFewestErrorsOfStep = 3;
constexpr float kNormalClusterRad = 0.5236F;  // same as for models, so that their pairs match
static_assert(kNormalClusterRad > (kNormalClusterDeg - 0.01F) * std::numbers::pi_v<float> / 180 &&
                  kNormalClusterRad < (kNormalClusterDeg + 0.01F) * std::numbers::pi_v<float> / 180,
              "scenes are thinned as models are");
constexpr std::size_t kMostSamples = std::size_t{1} << 18;  // maximum for a closed surface
// Bounds on the points in the voxel of a point of a closed surface, in the mean, and so on the
// neighbors for fitting normals: a ball holds some 4 times as many as a voxel as wide as its radius.
constexpr double kMostInCell = 6;    // voxels as wide as the spacing; one surface has 2 or 3
constexpr double kMostSurfaces = 2;  // in voxels as wide as the window, each a flat surface
constexpr double kMostPixels = 256;  // maximum pixels per point on one side of a closed surface

/// Half-width of the window for measuring the scene's noise, in pixels or spacings.
constexpr std::uint32_t kNoiseWindow = 2;

/// Half-width of the window for normals. It is wide enough that the noise turns them by about the
/// quantization of the pair's angles, and no wider, since corners become rounded.
float choose_window(float noise, float spacing) {
  return std::clamp(2 + 3.5F * noise / spacing, 2.0F, 7.0F);
}

/// Pixel geometry of the sensor: given, recovered from the grid, or constructed for scattered
/// points.
struct SensorView {
  kernels::ImageGeometry geometry;
  PixelGrid grid;
  bool scattered = false;  ///< whether points lie beside the rays through their pixels' centers
};

/// Depth at a pixel's center of the plane through one of its points. Where the plane is so oblique
/// that it leaves the pixel far from the point, the point's own depth.
float depth_at_center(const kernels::ImageGeometry& geometry, std::size_t pixel,
                      const Eigen::Vector3f& point, const Eigen::Vector3f& normal) {
  const Eigen::Vector3f ray = geometry.back_project(pixel, 1);
  const float depth = normal.dot(point) / normal.dot(ray);
  const bool is_near = std::abs(depth - point.z()) < 4 * point.z() / geometry.fx;
  return is_near ? depth : point.z();  // also where there is no normal
}

/// Depth and normal of each pixel from the points in the grid.
kernels::RangeImage make_image(const SensorView& view, const OrientedView& cloud) {
  const kernels::ImageGeometry& geometry = view.geometry;
  kernels::RangeImage image;
  image.geometry = geometry;
  const std::size_t n = view.grid.point_index.size();
  image.depth.assign(n, 0);
  image.plane.assign(n, 0);
  image.near_plane.assign(n, 0);
  image.normals.resize(n);
  const Eigen::Matrix3f R = geometry.T_camera_scene.linear();
  for_chunks(n, kPixelGrain, [&](std::size_t first, std::size_t count) {
    for (std::size_t pixel = first; pixel < first + count; ++pixel) {
      const std::int32_t i = view.grid.point_index[pixel];
      if (i == PixelGrid::kNone) {
        image.normals.set(pixel, Eigen::Vector3f::Constant(kNaN));
        continue;
      }
      const auto at = static_cast<std::size_t>(i);
      const Eigen::Vector3f p = geometry.T_camera_scene * cloud.points[at];
      const Eigen::Vector3f normal = R * cloud.normals[at];
      image.depth[pixel] = view.scattered ? depth_at_center(geometry, pixel, p, normal) : p.z();
      image.normals.set(pixel, normal);
    }
  });
  return image;
}

/// Fill single missing pixels, which scattered points leave between them, with their neighbors'
/// normals.
void close_holes(float max_step, kernels::RangeImage& image) {
  const Column<float> measured = image.depth;
  kernels::fill_small_holes(image.geometry, max_step, 4, image.depth);
  const std::size_t width = image.geometry.width;
  StopCheck check_stop(kPixelGrain);
  for (std::size_t pixel = width + 1; pixel + width + 1 < measured.size(); ++pixel) {
    check_stop();
    if (measured[pixel] > 0 || !(image.depth[pixel] > 0)) continue;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const std::size_t row : {pixel - width, pixel, pixel + width}) {
      for (const std::size_t at : {row - 1, row, row + 1}) {
        if (std::isfinite(image.normals.view().x[at])) sum += image.normals[at];
      }
    }
    if (sum.norm() > 0) image.normals.set(pixel, sum.normalized());
  }
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
  constexpr std::size_t kMaxWindow = kernels::GridNormalOptions::kMaxWindow;
  const std::size_t window =
      2 * clamped_integer(std::round(scene.window), std::size_t{1}, kMaxWindow) + 1;
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

kernels::StepCounts count_steps(const kernels::RangeImage& image) {
  const std::size_t width = image.geometry.width, height = image.geometry.height;
  const std::size_t row_chunks = (height + kRowGrain - 1) / kRowGrain;
  std::vector<kernels::StepCounts> counts(row_chunks + (width + kRowGrain - 1) / kRowGrain);
  for_each_index(counts.size(), [&](std::size_t k) {
    const bool of_rows = k < row_chunks;
    const std::size_t first = (of_rows ? k : k - row_chunks) * kRowGrain;
    const std::size_t num = std::min(kRowGrain, (of_rows ? height : width) - first);
    counts[k] = of_rows ? kernels::count_steps_of_rows(image, first, num)
                        : kernels::count_steps_of_columns(image, first, num);
  });
  kernels::StepCounts all;
  for (const kernels::StepCounts& some : counts) all += some;
  return all;
}

/// Measure how the sensor's error depends on range and how it is shared by neighboring pixels.
/// Noise and correlated noise are already measured.
void measure_sensor(const kernels::RangeImage& image, const PrepareOptions& options,
                    kernels::SensorModel& sensor) {
  std::vector<float> ranges;
  for (const float d : image.depth) {
    if (d > 0) ranges.push_back(d);
  }
  check_stop();
  sensor.range = kernels::median(std::span(ranges));
  if (!options.correlated_noise) return;
  const std::size_t height = image.geometry.height;
  std::vector<std::vector<kernels::SmoothPatch>> rows((height + kRowGrain - 1) / kRowGrain);
  for_each_index(rows.size(), [&](std::size_t k) {
    const std::size_t first = k * kRowGrain;
    kernels::measure_patches(image, first, std::min(kRowGrain, height - first), rows[k]);
  });
  std::vector<kernels::SmoothPatch> patches;
  for (const auto& row : rows) patches.insert(patches.end(), row.begin(), row.end());
  kernels::fit_sensor_model(patches, sensor);
  sensor.may_be_smoothed = kernels::may_be_smoothed(count_steps(image));
}

Error too_few_points(const SceneInput& input, std::string_view which, std::size_t num_points) {
  return {ErrorCode::bad_data, fmt::format("{}: expected a scan of at least {} points{}, found {}",
                                           input.file.string(), kFewestPoints, which, num_points)};
}

/// recovered  geometry that the grid or the rays of the points determine [library unit]
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

  Column<float> footprints;
  for (std::size_t i = 0; i < scene.points.size(); i += 1 + scene.points.size() / 20000) {
    footprints.push_back((geometry.T_camera_scene * scene.points[i]).z() / geometry.fx);
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
  scene.window = options.normal_window.value_or(choose_window(scene.sensor.noise, scene.spacing));
  const auto window =
      clamped_integer(std::round(scene.window), 1U, kernels::GridNormalOptions::kMaxWindow);
  if (window != kNoiseWindow) estimate(window);

  scene.images.push_back(make_image(*view, {scene.points, scene.normals}));
  if (view->scattered) close_holes(3 * scene.spacing, scene.images.back());
  find_dominant_planes(scene.images.back(), options, scene);
  measure_sensor(scene.images.back(), options, scene.sensor);
  return {};
}

/// Unit normals of the vertices: sums of their faces' normals, weighted by area.
Normals vertex_normals(PointsView points, const Triangles& triangles) {
  Normals normals(points.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Eigen::Vector3f a = points[triangles.a[t]];
    const Eigen::Vector3f n = (points[triangles.b[t]] - a).cross(points[triangles.c[t]] - a);
    for (const std::uint32_t corner : {triangles.a[t], triangles.b[t], triangles.c[t]}) {
      normals.set(corner, normals[corner] + n);
    }
  }
  return normals;
}

/// The number of points in the voxel of a point, itself included: the mean over all points.
double mean_in_voxel(const Points& points, float cell, kernels::SubsampleScratch& scratch) {
  kernels::group_by_voxel(points, kernels::fit_lattice(points, cell), scratch.voxels,
                          scratch.grouping);
  double num_pairs = 0;  // pairs of points that share a voxel
  for (std::size_t v = 0; v < scratch.voxels.size(); ++v) {
    const auto count = static_cast<double>(scratch.voxels.points_of(v).size());
    num_pairs += count * count;
  }
  return num_pairs / static_cast<double>(points.size());
}

/// Where surfaces coincide, keep one of those with the same orientation, and where too many of
/// different orientations meet, one of all; otherwise each point would have one neighbor per layer.
/// Returns whether any surfaces coincided; the points are then about `cell` apart.
bool keep_one_layer(float cell, Points& points, Normals& outward) {
  kernels::SubsampleScratch scratch;
  bool is_thinned = false;
  for (const float max_angle_rad : {kNormalClusterRad, std::numbers::pi_v<float>}) {
    if (points.empty() || mean_in_voxel(points, cell, scratch) <= kMostInCell) break;
    for (std::size_t i = 0; i < outward.size(); ++i) {
      const float length = outward[i].norm();  // 0 for a vertex without faces, which gives NaN
      outward.set(i, outward[i] / length);
    }
    Points kept;
    Normals kept_outward;
    kernels::subsample_by_normals({points, outward}, cell, max_angle_rad, kept, kept_outward,
                                  scratch);
    points = std::move(kept);
    outward = std::move(kept_outward);
    is_thinned = true;
  }
  return is_thinned;
}

/// Points with outward normals all over a closed mesh. These are its vertices where they are as
/// dense as a scan, and otherwise samples of its faces, since a CAD mesh has vertices at its
/// corners only. A mesh without area yields few or no points.
Normals cover_surface(const Triangles& triangles, PreparedScene& scene) {
  std::vector<double> area_sums(triangles.size());
  const double area = kernels::sum_areas(scene.points, triangles, area_sums);
  const double extent = static_cast<double>(bounding_box(scene.points).diagonal().norm());
  const double widest_spacing = 0.01 * extent;
  const std::size_t num_needed =
      clamped_integer(area / (widest_spacing * widest_spacing), std::size_t{0}, kMostSamples / 2);
  const bool shares_vertices =
      scene.points.size() <= triangles.size();  // otherwise points would coincide
  Normals normals;
  float cell = 0;  // spacing of the points of a single layer
  if (shares_vertices && scene.points.size() >= num_needed) {
    // For a mesh with almost no area for its extent, pixels would far outnumber points.
    const auto n = static_cast<double>(scene.points.size());
    scene.spacing =
        static_cast<float>(std::max(std::sqrt(area / n), extent / std::sqrt(kMostPixels * n)));
    cell = scene.spacing;
    normals = vertex_normals(scene.points, triangles);
  } else {
    const std::size_t n = 2 * num_needed;
    Points points(n);
    normals.resize(n);
    for_chunks(n, 1024, [&](std::size_t first, std::size_t count) {
      kernels::sample_mesh({scene.points, triangles, area_sums}, 0, first, n,
                           {points.span().slice(first, count), normals.span().slice(first, count)});
    });
    scene.points = std::move(points);
    scene.spacing = static_cast<float>(std::sqrt(area / static_cast<double>(n)));
    cell = static_cast<float>(widest_spacing / std::numbers::sqrt2);
  }
  if (keep_one_layer(cell, scene.points, normals)) scene.spacing = cell;
  return normals;
}

/// Normals of planes fitted to the points within a radius, with undetermined sign, and the
/// residuals.
void fit_normals(const Points& points, float radius, NormalsSpan normals,
                 std::span<float> residuals) {
  const kernels::VoxelHash grid(points, radius);
  for_chunks(points.size(), 512, [&](std::size_t first, std::size_t count) {
    const PointsView queries = points.view().slice(first, count);
    Neighborhoods rows;  // one chunk at a time, as all together would be large
    rows.offsets.assign(count + 1, 0);
    kernels::count_radius_neighbors(grid, queries, radius, std::span(rows.offsets).first(count));
    rows.indices.resize(counts_to_offsets(rows.offsets));
    kernels::fill_radius_neighbors(grid, queries, radius, rows.offsets, rows.indices);
    kernels::estimate_normals(points, rows, normals.slice(first, count),
                              residuals.subspan(first, count));
  });
}

/// The window, narrowed while its voxels hold more points than kMostSurfaces flat surfaces have.
float narrow_window(const PreparedScene& scene) {
  kernels::SubsampleScratch scratch;
  float window = scene.window;
  while (window > kNoiseWindow && mean_in_voxel(scene.points, window * scene.spacing, scratch) >
                                      kMostSurfaces * window * window)
    window = std::max(window / 1.25F, static_cast<float>(kNoiseWindow));
  return window;
}

/// Prepare a surface that is visible from all around.
///
/// triangles  triangles of scene.points
Result<void> prepare_closed_scene(const Triangles& triangles, const SceneInput& input,
                                  const PrepareOptions& options, PreparedScene& scene) {
  const Normals outward = cover_surface(triangles, scene);
  const std::size_t n = scene.points.size();
  if (n < kFewestPoints) {
    return Error{
        ErrorCode::bad_data,
        fmt::format("{}: expected a closed surface, found {} with next to no area; give a "
                    "scan, or a mesh of what is to be searched",
                    input.file.string(), counted(triangles.size(), "triangle", "triangles"))};
  }
  scene.normals.resize(n);
  Column<float> residuals(n);
  const auto estimate = [&](float window) {
    fit_normals(scene.points, window * scene.spacing, scene.normals, residuals);
  };
  estimate(kNoiseWindow);
  Column<float> finite;
  for (const float r : residuals) {
    if (std::isfinite(r)) finite.push_back(r);
  }
  scene.sensor.noise = kernels::median(std::span(finite));
  scene.window = options.normal_window.value_or(choose_window(scene.sensor.noise, scene.spacing));
  scene.window = narrow_window(scene);
  // Windows that differ by less contain mostly the same points.
  if (std::abs(scene.window - kNoiseWindow) > 0.25F) estimate(scene.window);
  for (std::size_t i = 0; i < n; ++i) {
    if (scene.normals[i].dot(outward[i]) < 0) scene.normals.set(i, -scene.normals[i]);
  }

  // Six distant cameras around the surface see it as sensors would.
  const Eigen::AlignedBox3f box = bounding_box(scene.points);
  const Eigen::Vector3f middle = (box.min() + box.max()) / 2;
  const float distance = 10 * box.diagonal().norm();
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      const Eigen::Vector3f eye = middle + side * distance * Eigen::Vector3f::Unit(axis);
      std::optional<kernels::ImageGeometry> geometry =
          kernels::choose_camera(scene.points, eye, 1.5F * scene.spacing);
      if (!geometry) continue;
      kernels::MergedPixels merged = kernels::merge_pixels(*geometry, scene.points, scene.normals);
      scene.images.push_back(
          make_image({*geometry, std::move(merged.grid), true}, {merged.points, merged.normals}));
      close_holes(3 * scene.spacing, scene.images.back());
    }
  }
  if (scene.images.empty()) {
    return Error{
        ErrorCode::bad_data,
        fmt::format("{}: expected a closed surface that can be seen from some side, found "
                    "{} that cannot",
                    input.file.string(), counted(triangles.size(), "triangle", "triangles"))};
  }
  return {};
}

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
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    check_stop();
    if (!explained.empty() && is_explained(scene, explained, sample.points[i], sample.step))
      continue;
    level.points.push_back(sample.points[i]);
    level.normals.push_back(sample.normals[i]);
  }

  level.references.resize(level.points.size());
  std::iota(level.references.begin(), level.references.end(), 0U);
  const std::size_t num_references =
      clamped_integer(std::ceil(options.reference_share * static_cast<float>(level.points.size())),
                      std::size_t{0}, std::size_t{options.max_references});
  level.references.resize(thin_by_pixels(scene, level.points, num_references, level.references));
  level.grid =
      kernels::VoxelHash(level.points, std::max(sample.step, 0.25F * sample.largest_diameter));
  return level;
}

}  // namespace trivet::engine
