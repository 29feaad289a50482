#include "engine/scene/prepare_closed_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/common/parallel.hpp"
#include "engine/scene/sensor_image.hpp"
#include "kernels/common/median.hpp"
#include "kernels/scans/merge_pixels.hpp"
#include "kernels/surfaces/estimate_normals.hpp"
#include "kernels/surfaces/sample_mesh.hpp"
#include "kernels/surfaces/subsample_by_normals.hpp"
#include "storage/common/clamped_integer.hpp"
#include "storage/common/counted.hpp"
#include "storage/data/bounding_box.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kMostSamples = std::size_t{1} << 18;  // maximum for a closed surface
// Bounds on the points in the voxel of a point of a closed surface, in the mean, and so on the
// neighbors for fitting normals: a ball holds some 4 times as many as a voxel as wide as its radius.
constexpr double kMostInCell = 6;    // voxels as wide as the spacing; one surface has 2 or 3
constexpr double kMostSurfaces = 2;  // in voxels as wide as the window, each a flat surface
constexpr double kMostPixels = 256;  // maximum pixels per point on one side of a closed surface

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

}  // namespace

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

}  // namespace trivet::engine
