#include "engine/meshing/surface_from_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/common/check_extent.hpp"
#include "engine/common/check_range.hpp"
#include "engine/common/parallel.hpp"
#include "engine/scene/find_viewpoint.hpp"
#include "kernels/common/nearest_neighbors.hpp"
#include "kernels/meshing/boundary_share.hpp"
#include "kernels/scans/estimate_normals_grid.hpp"
#include "kernels/surfaces/estimate_normals.hpp"
#include "storage/common/counted.hpp"

namespace trivet {
namespace {

using engine::for_chunks;

constexpr std::size_t kRowGrain = 8;  // image rows per task
// Bands of distance, since sensor errors increase with range.
constexpr std::size_t kNoiseBands = 10;
constexpr std::size_t kPointGrain = 512;
// Neighbors for fitting a plane, within about 2.5 spacings.
constexpr std::size_t kNormalNeighbors = 20;
// Share of all possible triangles between pixels. More triangles are seen from behind only from a
// wrong viewpoint.
constexpr double kManyBehind = 0.05;

Result<SurfaceMethod> choose_method(const Cloud& cloud, const std::string& name,
                                    const SurfaceOptions& options) {
  if (!options.method) {
    return !cloud.triangles.empty() ? SurfaceMethod::faces
           : cloud.grid             ? SurfaceMethod::grid
                                    : SurfaceMethod::greedy;
  }
  const bool lacks_faces = options.method == SurfaceMethod::faces && cloud.triangles.empty();
  const bool lacks_grid = options.method == SurfaceMethod::grid && !cloud.grid;
  if (lacks_faces || lacks_grid) {
    return Error{
        ErrorCode::usage,
        fmt::format("{}: the method '{}' expects {}, found {} points without; leave the "
                    "method out to take what suits the file",
                    name, lacks_faces ? "faces" : "grid",
                    lacks_faces ? "a file with faces" : "an organized scan", cloud.points.size())};
  }
  return *options.method;
}

/// The noise of a scan at each point, measured on the tenth of the points at a similar distance.
Column<float> measure_noise(const PixelGrid& grid, PointsView points,
                            const Eigen::Vector3f& viewpoint) {
  const std::size_t n = points.size();
  kernels::PixelPoints pixels;
  kernels::arrange_pixels(grid, points, pixels);
  Normals normals(n);
  Column<float> residuals(n, NAN);
  for_chunks(grid.height, kRowGrain, [&](std::size_t first, std::size_t count) {
    kernels::estimate_normals_grid({grid, pixels, viewpoint}, {.window = 2}, first, count, normals,
                                   residuals);
  });

  std::vector<std::pair<float, std::uint32_t>> by_distance;
  for (std::uint32_t i = 0; i < n; ++i)
    by_distance.emplace_back((points[i] - viewpoint).squaredNorm(), i);
  std::ranges::sort(by_distance);
  Column<float> noise(n), band, scratch;
  for (std::size_t k = 0; k < kNoiseBands; ++k) {
    const auto members =
        std::span(by_distance)
            .subspan(k * n / kNoiseBands, (k + 1) * n / kNoiseBands - k * n / kNoiseBands);
    band.clear();
    for (const auto& [distance, i] : members) band.push_back(residuals[i]);
    const float sigma = kernels::estimate_scan_noise(band, scratch);
    for (const auto& [distance, i] : members) noise[i] = sigma;
  }
  return noise;
}

/// Estimate normals. Errors: bad_data (a point is not finite), no_memory.
Result<Normals> estimate_normals(PointsView points, const Eigen::Vector3f& viewpoint) {
  const std::size_t n = points.size(), k = std::min(kNormalNeighbors, n);
  TRIVET_TRY_ASSIGN(const kernels::NearestNeighbors tree, kernels::NearestNeighbors::build(points));
  Neighborhoods rows;
  for (std::size_t i = 0; i <= n; ++i) rows.offsets.push_back(static_cast<std::uint32_t>(i * k));
  rows.indices.resize(n * k);
  std::vector<float> squared(n * k);
  Normals normals(n);
  std::vector<std::optional<Error>> errors(n);  // one per chunk, at its first point
  for_chunks(n, kPointGrain, [&](std::size_t first, std::size_t count) {
    const Result<void> found = tree.k_nearest(points.slice(first, count), k,
                                              std::span(rows.indices).subspan(first * k, count * k),
                                              std::span(squared).subspan(first * k, count * k));
    if (!found) {
      errors[first] = found.error();
      return;
    }
    const NormalsSpan out = normals.span().slice(first, count);
    kernels::estimate_normals(points, rows.view().rows(first, count), out);
    kernels::orient_normals(points.slice(first, count), viewpoint, out);
  });
  for (const std::optional<Error>& error : errors) {
    if (error) return *error;
  }
  return normals;
}

std::size_t count_used(const Cloud& mesh) {
  std::vector<std::uint8_t> is_used(mesh.points.size(), 0);
  for (const auto* corners : {&mesh.triangles.a, &mesh.triangles.b, &mesh.triangles.c}) {
    for (const std::uint32_t v : *corners) is_used[v] = 1;
  }
  return static_cast<std::size_t>(std::ranges::count(is_used, 1));
}

void span_pixels(const std::string& name, const Eigen::Vector3f& viewpoint,
                 const SurfaceOptions& options, Surface& surface) {
  Cloud& mesh = surface.mesh;
  const Column<float> noise = measure_noise(*mesh.grid, mesh.points, viewpoint);
  kernels::GridTriangulationStats stats;
  mesh.triangles =
      kernels::triangulate_grid(*mesh.grid, mesh.points, viewpoint, noise, options.grid, &stats);
  const double num_smooth = static_cast<double>(mesh.triangles.size() + stats.num_behind);
  if (static_cast<double>(stats.num_behind) > kManyBehind * num_smooth) {
    surface.warning = fmt::format(
        "{}: {} left out as the viewpoint ({}, {}, {}) is behind them; give the "
        "sensor's position with --viewpoint",
        name, counted(stats.num_behind, "triangle was", "triangles were"), viewpoint.x(),
        viewpoint.y(), viewpoint.z());
  }
}

}  // namespace

Result<void> validate(const SurfaceOptions& options) {
  const kernels::GridTriangulationOptions& grid = options.grid;
  const kernels::GreedyOptions& greedy = options.greedy;
  return engine::check_ranges({
      {grid.max_jump >= 1, "max jump [footprints]", "at least 1", grid.max_jump},
      {grid.max_grazing_deg > 0 && grid.max_grazing_deg < 90, "max grazing [deg]",
       "above 0, below 90", grid.max_grazing_deg},
      {greedy.max_neighbors >= 8, "max neighbors", "at least 8",
       static_cast<double>(greedy.max_neighbors)},
      {greedy.radius > 0, "radius", "above 0", greedy.radius},
      {greedy.mu >= 1 && greedy.mu <= 10, "mu [spacings]", "1 to 10", greedy.mu},
      {greedy.min_angle_deg >= 0 && greedy.min_angle_deg <= 60, "min angle [deg]", "0 to 60",
       greedy.min_angle_deg},
      {greedy.max_angle_deg >= 60 && greedy.max_angle_deg < 180, "max angle [deg]",
       "60 to below 180", greedy.max_angle_deg},
      {greedy.max_normal_angle_deg > 0 && greedy.max_normal_angle_deg <= 90,
       "max normal angle [deg]", "above 0 to 90", greedy.max_normal_angle_deg},
  });
}

Result<Surface> surface_from_points(Cloud cloud, const std::string& name,
                                    const SurfaceOptions& options) {
  TRIVET_TRY(validate(options));
  TRIVET_TRY_ASSIGN(const SurfaceMethod method, choose_method(cloud, name, options));
  if (cloud.points.size() < 3) {
    return Error{ErrorCode::bad_data, fmt::format("{}: expected at least 3 points, found {}", name,
                                                  cloud.points.size())};
  }
  TRIVET_TRY(engine::check_extent(cloud.points, name));
  const Result<Eigen::Vector3f> place = engine::find_viewpoint(cloud, options.viewpoint, name);
  const bool needs_viewpoint =
      method == SurfaceMethod::grid || (method == SurfaceMethod::greedy && cloud.normals.empty());
  if (needs_viewpoint && !place) return place.error();
  const Eigen::Vector3f viewpoint = place ? *place : Eigen::Vector3f::Zero();

  Surface surface;
  surface.method = method;
  surface.mesh = std::move(cloud);
  Cloud& mesh = surface.mesh;
  if (method == SurfaceMethod::grid) {
    span_pixels(name, viewpoint, options, surface);
  } else if (method == SurfaceMethod::greedy) {
    TRIVET_TRY_ASSIGN(Normals normals, mesh.normals.empty()
                                           ? estimate_normals(mesh.points, viewpoint)
                                           : Result<Normals>(mesh.normals));
    TRIVET_TRY_ASSIGN(Triangles triangles,
                      kernels::triangulate_greedy(mesh.points, normals, options.greedy));
    mesh.triangles = std::move(triangles);
  }
  if (mesh.triangles.empty()) {
    return Error{
        ErrorCode::bad_data,
        fmt::format("{}: expected points on a surface seen from ({}, {}, {}), found {} "
                    "that no triangle could be laid through; give the sensor's position "
                    "with --viewpoint, or another --method",
                    name, viewpoint.x(), viewpoint.y(), viewpoint.z(), mesh.points.size())};
  }
  surface.num_used = count_used(mesh);
  surface.open_share = kernels::boundary_share(mesh.triangles);
  return surface;
}

}  // namespace trivet
