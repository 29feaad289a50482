#include "engine/training/model_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/common/parallel.hpp"
#include "engine/training/orient_by_samples.hpp"
#include "engine/training/scaled_points.hpp"
#include "kernels/common/nearest_neighbors.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "kernels/meshing/triangulate_cloud.hpp"
#include "kernels/surfaces/diameter.hpp"
#include "kernels/surfaces/estimate_normals.hpp"
#include "kernels/surfaces/sample_mesh.hpp"
#include "kernels/surfaces/subsample_by_normals.hpp"
#include "kernels/surfaces/visibility.hpp"
#include "kernels/symmetry/find_near_symmetries.hpp"
#include "kernels/symmetry/find_symmetry.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kViewGrain = 16;        // a sample shoots some 300 rays
constexpr std::size_t kNormalNeighbors = 16;  // of a cloud's point, for the plane through it
constexpr double kDensePerVoxel = 10;         // surface samples averaged into one point
constexpr double kFewestDense = 4096, kMostDense = 400'000;

/// Sample a mesh; the normals are those of the faces and as reliable as the winding.
SpreadPoints spread_over(const Model& model, std::span<const double> areas, std::uint64_t seed,
                         std::size_t n) {
  SpreadPoints surface;
  surface.points.resize(n);
  surface.normals.resize(n);
  for_chunks(n, 1024, [&](std::size_t first, std::size_t count) {
    kernels::sample_mesh(model.vertices, model.triangles, areas, seed, first, n,
                         surface.points.span().slice(first, count),
                         surface.normals.span().slice(first, count));
  });
  surface.spacing = static_cast<float>(std::sqrt(areas.back() / static_cast<double>(n)));
  return surface;
}

/// Thin a cloud evenly and fit normals; their signs are open.
SpreadPoints thin_cloud(PointsView points, float cell) {
  SpreadPoints surface;
  Normals up(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) up.set(i, Eigen::Vector3f::UnitZ());
  kernels::SubsampleScratch scratch;
  kernels::subsample_by_normals(points, up, cell, 4, surface.points, surface.normals, scratch);
  const kernels::VoxelHash grid(points, 2 * cell);
  surface.normals.resize(surface.points.size());
  Neighborhoods rows;
  rows.offsets.assign(surface.points.size() + 1, 0);
  kernels::count_radius_neighbors(grid, surface.points, 2.5F * cell,
                                  std::span(rows.offsets).first(surface.points.size()));
  rows.indices.resize(counts_to_offsets(rows.offsets));
  kernels::fill_radius_neighbors(grid, surface.points, 2.5F * cell, rows.offsets, rows.indices);
  kernels::estimate_normals(points, rows, surface.normals);
  surface.spacing = cell;
  return surface;
}

/// The faces of a surface that came as points: normals from the nearest points, turned to the
/// outside. None if the points lie on no surface; parts of it may stay open.
/// Errors: internal (out of memory).
Result<Triangles> faces_of_cloud(PointsView points) {
  const kernels::Delaunay delaunay = kernels::find_delaunay(points);
  const std::size_t n = delaunay.places.size();
  Points places(n);  // points that coincide would crowd out neighbors
  for (std::size_t i = 0; i < n; ++i) places.set(i, points[delaunay.places[i]]);

  const std::size_t num_near = std::min(kNormalNeighbors, n);
  const Result<kernels::NearestNeighbors> tree = kernels::NearestNeighbors::build(places);
  if (!tree) return tree.error();
  Neighborhoods near;
  for (std::size_t i = 0; i <= n; ++i)
    near.offsets.push_back(static_cast<std::uint32_t>(i * num_near));
  near.indices.resize(n * num_near);
  std::vector<float> squared(near.indices.size());
  if (const Result<void> found = tree->k_nearest(places, num_near, near.indices, squared); !found)
    return found.error();
  Normals normals_of_places(n), normals(points.size());
  kernels::estimate_normals(places, near, normals_of_places);
  for (std::size_t i = 0; i < n; ++i) normals.set(delaunay.places[i], normals_of_places[i]);

  const kernels::TriangulateOptions options;
  const Result<void> oriented =
      kernels::orient_by_empty_space(points, delaunay, options.max_radius, normals);
  if (!oriented) return oriented.error();
  Result<Triangles> faces = kernels::triangulate_cloud(points, delaunay, normals, options);
  // A closed surface has two triangles a point; what has less than one is none, or torn.
  if (faces && faces->size() < n) *faces = {};
  return faces;
}

/// A fixed shuffle, so that every prefix of the samples covers the surface evenly.
std::uint64_t shuffle_key(std::uint64_t i) {
  i = (i + 0x9E3779B97F4A7C15ULL) * 0xBF58476D1CE4E5B9ULL;
  i = (i ^ (i >> 27)) * 0x94D049BB133111EBULL;
  return i ^ (i >> 31);
}

/// Keep the samples that some view sees, shuffled.
std::size_t keep_visible_samples(const SpreadPoints& surface, std::span<const ViewMask> views,
                                 Model& model) {
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < views.size(); ++i) {
    if (views[i] != ViewMask{}) kept.push_back(i);
  }
  std::sort(kept.begin(), kept.end(),
            [](std::uint32_t a, std::uint32_t b) { return shuffle_key(a) < shuffle_key(b); });
  model.samples.resize(kept.size());
  model.sample_normals.resize(kept.size());
  model.sample_views.resize(kept.size());
  for (std::size_t k = 0; k < kept.size(); ++k) {
    model.samples.set(k, surface.points[kept[k]]);
    model.sample_normals.set(k, surface.normals[kept[k]]);
    model.sample_views[k] = views[kept[k]];
  }
  return views.size() - kept.size();
}

}  // namespace

Error bad_surface(const ModelSource& source, const std::string& found) {
  return {
      ErrorCode::bad_data,
      fmt::format("{}: model '{}': expected a surface with extent in three dimensions, found {}; "
                  "give a mesh or a cloud of the whole object",
                  source.file.string(), source.name, found)};
}

Result<ModelSurface> survey_model(const Cloud& cloud, const ModelSource& source,
                                  const TrainOptions& options, Model& model, TrainStats& stats) {
  model.name = source.name;
  model.source = source.file.filename().string();
  model.vertices = scaled_points(cloud.points, source.scale);
  model.triangles = cloud.triangles;
  {
    const StageTimer timer(stats.times, "diameter");
    model.diameter = kernels::find_diameter(model.vertices);
  }
  if (!(model.diameter > 0) || !std::isfinite(model.diameter)) {
    return bad_surface(source,
                       fmt::format("{} points within {}", model.vertices.size(), model.diameter));
  }

  if (model.triangles.empty()) {
    const StageTimer timer(stats.times, "triangulate");
    Result<Triangles> faces = faces_of_cloud(model.vertices);
    if (!faces) return faces.error();
    model.triangles = std::move(*faces);
  }

  std::vector<double> areas(model.triangles.size());
  const double area =
      areas.empty() ? 0 : kernels::sum_areas(model.vertices, model.triangles, areas);
  if (!(area > 1e-9 * std::pow(static_cast<double>(model.diameter), 2))) areas.clear();
  const bool has_faces = !areas.empty();
  SpreadPoints spread;
  Result<kernels::RayScene> rays = [&] {
    const StageTimer timer(stats.times, "sample");
    if (has_faces) {
      spread = spread_over(model, areas, 1, options.num_samples);
      return kernels::RayScene::from_mesh(model.vertices, model.triangles);
    }
    spread = thin_cloud(model.vertices, model.diameter / 40);
    return kernels::RayScene::from_spheres(spread.points, kernels::kCloudRadius * spread.spacing);
  }();
  if (!rays) return rays.error();
  const float offset = has_faces ? 1e-4F * model.diameter : kernels::kCloudOffset * spread.spacing;
  ModelSurface surface{std::move(spread), {}, std::move(areas), std::move(*rays), offset};
  SpreadPoints& samples = surface.samples;
  if (samples.points.size() < 20) {
    return bad_surface(source, fmt::format("only {} distinct places", samples.points.size()));
  }
  surface.views.resize(samples.points.size());
  {
    const StageTimer timer(stats.times, "visibility");
    for_chunks(surface.views.size(), kViewGrain, [&](std::size_t first, std::size_t count) {
      kernels::orient_outward(surface.rays, samples.points.view().slice(first, count),
                              samples.normals.span().slice(first, count), surface.ray_offset,
                              std::span(surface.views).subspan(first, count));
    });
    stats.num_hidden_samples = keep_visible_samples(samples, surface.views, model);
  }
  if (model.samples.size() < 20) {
    return bad_surface(
        source, fmt::format("only {} places that can be seen from outside", model.samples.size()));
  }
  model.sample_spacing = samples.spacing;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < model.samples.size(); ++i) center += model.samples[i].cast<double>();
  model.center = (center / static_cast<double>(model.samples.size())).cast<float>();
  return surface;
}

void find_symmetries(const ModelSource& source, Model& model, TrainStats& stats) {
  {
    const StageTimer timer(stats.times, "symmetry");
    model.symmetry = source.symmetry ? *source.symmetry
                                     : kernels::find_symmetry(model.samples, model.sample_normals,
                                                              model.diameter);
  }
  {
    const StageTimer timer(stats.times, "near symmetry");
    const kernels::ModelSamples surface_samples{model.samples,      model.sample_normals,
                                                model.sample_views, model.sample_spacing,
                                                model.diameter,     model.center};
    kernels::NearSymmetries near = kernels::find_near_symmetries(surface_samples, model.symmetry);
    model.near_symmetries = std::move(near.motions);
    model.near_axis = near.axis;
  }
}

void sample_evenly(const Model& model, const ModelSurface& surface, float step, float max_angle_rad,
                   Points& points, Normals& normals) {
  SpreadPoints dense;
  if (surface.has_faces()) {
    const double voxels = surface.areas.back() / std::pow(static_cast<double>(step), 2);
    dense = spread_over(model, surface.areas, 2,
                        static_cast<std::size_t>(std::clamp(std::floor(voxels) * kDensePerVoxel,
                                                            kFewestDense, kMostDense)));
  } else {
    dense = thin_cloud(model.vertices, std::min(surface.samples.spacing, 0.5F * step));
  }
  orient_by_samples(surface.samples.points, surface.samples.normals, surface.views,
                    surface.samples.spacing, dense.points, dense.normals);
  kernels::SubsampleScratch scratch;
  kernels::subsample_by_normals(dense.points, dense.normals, step, max_angle_rad, points, normals,
                                scratch);
}

}  // namespace trivet::engine
