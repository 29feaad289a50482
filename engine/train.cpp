#include "engine/train.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/check_range.hpp"
#include "engine/orient_by_samples.hpp"
#include "engine/parallel.hpp"
#include "engine/scaled_points.hpp"
#include "kernels/diameter.hpp"
#include "kernels/estimate_normals.hpp"
#include "kernels/find_near_symmetries.hpp"
#include "kernels/find_symmetry.hpp"
#include "kernels/nearest_neighbours.hpp"
#include "kernels/ppf_table.hpp"
#include "kernels/ray_scene.hpp"
#include "kernels/sample_mesh.hpp"
#include "kernels/subsample_by_normals.hpp"
#include "kernels/triangulate_cloud.hpp"
#include "kernels/visibility.hpp"
#include "kernels/voxel_hash.hpp"

namespace trivet {
namespace {

using engine::for_chunks;

constexpr float kRadiansPerDegree = 3.14159265358979F / 180;
constexpr std::size_t kViewGrain = 16;  // a sample shoots some 300 rays
constexpr std::size_t kPairGrain = 16;  // references a task; each pairs with all points
constexpr std::size_t kTableChunks =
    8;  // fixed, so that the table does not depend on the number of threads
constexpr std::size_t kNormalNeighbours = 16;  // of a cloud's point, for the plane through it
constexpr std::size_t kMaxPpfPoints = 65536;   // what a 16-bit reference can name
constexpr std::size_t kDensePerVoxel = 10;  // surface samples averaged into one point of the table

/// Points with outward normals, spread over the surface, before subsampling.
struct DenseSurface {
  Points points;
  Normals normals;
  float spacing = 0;
};

Error bad_surface(const ModelSource& source, const std::string& found) {
  return {
      ErrorCode::bad_data,
      fmt::format("{}: model '{}': expected a surface with extent in three dimensions, found {}; "
                  "give a mesh or a cloud of the whole object",
                  source.file.string(), source.name, found)};
}

/// Sample a mesh; the normals are those of the faces and as reliable as the winding.
DenseSurface sample_surface(PointsView vertices, const Triangles& triangles,
                            std::span<const double> area_sums, std::uint64_t seed, std::size_t n) {
  DenseSurface surface;
  surface.points.resize(n);
  surface.normals.resize(n);
  for_chunks(n, 1024, [&](std::size_t first, std::size_t count) {
    kernels::sample_mesh(vertices, triangles, area_sums, seed, first, n,
                         surface.points.span().slice(first, count),
                         surface.normals.span().slice(first, count));
  });
  surface.spacing = static_cast<float>(std::sqrt(area_sums.back() / static_cast<double>(n)));
  return surface;
}

/// Thin a cloud evenly and fit normals; their signs are open.
DenseSurface surface_of_cloud(PointsView points, float cell) {
  DenseSurface surface;
  Normals up(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) up.set(i, Eigen::Vector3f::UnitZ());
  kernels::SubsampleScratch scratch;
  kernels::subsample_by_normals(points, up, cell, 4, surface.points, surface.normals, scratch);
  const kernels::VoxelHash grid(points, 2 * cell);
  surface.normals.resize(surface.points.size());
  Neighbourhoods rows;
  rows.offsets.assign(surface.points.size() + 1, 0);
  kernels::count_radius_neighbours(grid, surface.points, 2.5F * cell,
                                   std::span(rows.offsets).first(surface.points.size()));
  rows.indices.resize(engine::counts_to_offsets(rows.offsets));
  kernels::fill_radius_neighbours(grid, surface.points, 2.5F * cell, rows.offsets, rows.indices);
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
  Points places(n);  // points that coincide would crowd out neighbours
  for (std::size_t i = 0; i < n; ++i) places.set(i, points[delaunay.places[i]]);

  const std::size_t num_near = std::min(kNormalNeighbours, n);
  const Result<kernels::NearestNeighbours> tree = kernels::NearestNeighbours::build(places);
  if (!tree) return tree.error();
  Neighbourhoods near;
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
std::size_t keep_visible_samples(const DenseSurface& surface, std::span<const ViewMask> views,
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

struct PpfTable {
  Column<std::uint32_t> offsets;
  Column<PpfEntry> entries;
};

/// The views of the nearest sample with a like normal, for the co-visibility of pairs.
std::vector<ViewMask> views_of_points(const Model& model) {
  const kernels::VoxelHash grid(model.samples, 2 * model.sample_spacing);
  std::vector<ViewMask> views(model.ppf_points.size());
  for_chunks(views.size(), 256, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      // All near samples together: what any of them sees, the point may see.
      ViewMask mask{};
      grid.visit_within(model.ppf_points[i], 2 * model.sample_spacing, [&](std::uint32_t s, float) {
        if (model.sample_normals[s].dot(model.ppf_normals[i]) < 0.8F) return;
        for (std::size_t w = 0; w < kViewWords; ++w) mask[w] |= model.sample_views[s][w];
      });
      if (mask == ViewMask{}) mask.fill(~std::uint64_t{0});
      views[i] = mask;
    }
  });
  return views;
}

/// Put the points that pairs start at first: one of each set of symmetric copies, `spacing` apart.
/// Returns how many there are.
std::size_t references_first(float step, float spacing, Model& model) {
  std::vector<std::uint8_t> is_reference(model.ppf_points.size(), 1);
  kernels::choose_references(model.ppf_points, model.symmetry, step, is_reference);
  kernels::spread_references(model.ppf_points, model.ppf_normals, spacing, is_reference);
  std::vector<std::uint32_t> order(is_reference.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto rest = std::stable_partition(order.begin(), order.end(),
                                          [&](std::uint32_t i) { return is_reference[i] != 0; });
  const Points points = model.ppf_points;
  const Normals normals = model.ppf_normals;
  for (std::size_t k = 0; k < order.size(); ++k) {
    model.ppf_points.set(k, points[order[k]]);
    model.ppf_normals.set(k, normals[order[k]]);
  }
  return static_cast<std::size_t>(rest - order.begin());
}

Result<void> build_table(const ModelSource& source, const TrainOptions& options, float step,
                         Model& model) {
  const std::size_t num_references =
      references_first(step, options.reference_spacing * step, model);
  const std::vector<ViewMask> views = views_of_points(model);
  const kernels::PpfPoints points{model.ppf_points, model.ppf_normals, views};
  PpfQuantisation quantisation{step, static_cast<std::uint32_t>(std::ceil(model.diameter / step)),
                               options.num_angle_bins};
  const std::size_t num_cells = quantisation.num_cells();
  const std::size_t n = model.ppf_points.size();
  const std::size_t num_chunks =
      std::min(kTableChunks, (num_references + kPairGrain - 1) / kPairGrain);
  const auto chunk_first = [&](std::size_t chunk) { return num_references * chunk / num_chunks; };

  auto table = std::make_shared<PpfTable>();
  table->offsets.resize(num_cells + 1);
  Column<std::uint32_t> counts(num_chunks * num_cells, 0);
  engine::PerThread<kernels::PairScratch> scratch([&] { return kernels::PairScratch(n); });
  engine::for_each_index(num_chunks, [&](std::size_t chunk) {
    kernels::count_ppf_pairs(points, quantisation, chunk_first(chunk),
                             chunk_first(chunk + 1) - chunk_first(chunk), scratch.local(),
                             std::span(counts).subspan(chunk * num_cells, num_cells));
  });
  const std::uint64_t num_entries = kernels::scan_ppf_counts(counts, num_chunks, table->offsets);
  if (num_entries == 0) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: model '{}': expected 1 to 2^32 point pairs, found {} points that "
                             "give none or more; "
                             "choose another relative step than {}",
                             source.file.string(), source.name, n, options.relative_step)};
  }
  table->entries.resize(num_entries);
  engine::for_each_index(num_chunks, [&](std::size_t chunk) {
    kernels::fill_ppf_entries(
        points, quantisation, chunk_first(chunk), chunk_first(chunk + 1) - chunk_first(chunk),
        scratch.local(), std::span(counts).subspan(chunk * num_cells, num_cells), table->entries);
  });
  for_chunks(num_cells, 4096, [&](std::size_t first, std::size_t count) {
    kernels::sort_ppf_cells(table->offsets, first, count, table->entries);
  });
  model.ppf = {quantisation, static_cast<std::uint32_t>(num_references), table->offsets,
               table->entries};
  model.ppf_storage = std::move(table);
  return {};
}

}  // namespace

float sampling_step(float diameter, float relative_step) {
  return relative_step * std::exp2(std::round(4 * std::log2(diameter)) / 4);
}

Result<void> validate(const TrainOptions& options) {
  return engine::check_ranges({
      {options.relative_step >= 0.01F && options.relative_step <= 0.2F, "relative step",
       "0.01 to 0.2", options.relative_step},
      {options.reference_spacing >= 0 && options.reference_spacing <= 5,
       "reference spacing [steps]", "0 to 5", options.reference_spacing},
      {options.num_angle_bins >= 6 && options.num_angle_bins <= 60, "angle bins", "6 to 60",
       static_cast<double>(options.num_angle_bins)},
      {options.normal_cluster_angle_deg > 0 && options.normal_cluster_angle_deg <= 180,
       "normal cluster angle [deg]", "above 0 to 180", options.normal_cluster_angle_deg},
      {options.num_samples >= 256 && options.num_samples <= 1U << 20, "samples", "256 to 1048576",
       static_cast<double>(options.num_samples)},
  });
}

Result<TrainedModel> train_model(const Cloud& surface, const ModelSource& source,
                                 const TrainOptions& options) {
  TrainedModel trained;
  Model& model = trained.model;
  TrainStats& stats = trained.stats;
  model.name = source.name;
  model.source = source.file.filename().string();
  model.vertices = engine::scaled_points(surface.points, source.scale);
  model.triangles = surface.triangles;
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

  // Surface samples, which side is outside, and from where each can be seen.
  std::vector<double> area_sums(model.triangles.size());
  const double area =
      area_sums.empty() ? 0 : kernels::sum_areas(model.vertices, model.triangles, area_sums);
  const bool has_faces =
      area > 1e-9 * static_cast<double>(model.diameter) * static_cast<double>(model.diameter);
  const auto sample = [&](std::uint64_t seed, std::size_t n) {
    return sample_surface(model.vertices, model.triangles, area_sums, seed, n);
  };
  DenseSurface samples;
  Result<kernels::RayScene> rays = Error{ErrorCode::internal, ""};
  {
    const StageTimer timer(stats.times, "sample");
    if (has_faces) {
      samples = sample(1, options.num_samples);
      rays = kernels::RayScene::from_mesh(model.vertices, model.triangles);
    } else {
      samples = surface_of_cloud(model.vertices, model.diameter / 40);
      rays =
          kernels::RayScene::from_spheres(samples.points, kernels::kCloudRadius * samples.spacing);
    }
  }
  if (!rays) return rays.error();
  if (samples.points.size() < 20) {
    return bad_surface(source, fmt::format("only {} distinct places", samples.points.size()));
  }
  std::vector<ViewMask> views(samples.points.size());
  {
    const StageTimer timer(stats.times, "visibility");
    const float offset =
        has_faces ? 1e-4F * model.diameter : kernels::kCloudOffset * samples.spacing;
    for_chunks(views.size(), kViewGrain, [&](std::size_t first, std::size_t count) {
      kernels::orient_outward(*rays, samples.points.view().slice(first, count),
                              samples.normals.span().slice(first, count), offset,
                              std::span(views).subspan(first, count));
    });
    stats.num_hidden_samples = keep_visible_samples(samples, views, model);
  }
  if (model.samples.size() < 20) {
    return bad_surface(
        source, fmt::format("only {} places that can be seen from outside", model.samples.size()));
  }
  model.sample_spacing = samples.spacing;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < model.samples.size(); ++i) centre += model.samples[i].cast<double>();
  model.centre = (centre / static_cast<double>(model.samples.size())).cast<float>();

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
                                                model.diameter,     model.centre};
    kernels::NearSymmetries near = kernels::find_near_symmetries(surface_samples, model.symmetry);
    model.near_symmetries = std::move(near.motions);
    model.near_axis = near.axis;
  }

  // Points of the table: a dense surface, oriented, thinned by voxel and normal.
  const float step = sampling_step(model.diameter, options.relative_step);
  {
    const StageTimer timer(stats.times, "subsample");
    DenseSurface dense;
    if (has_faces) {
      const double voxels = area / (static_cast<double>(step) * static_cast<double>(step));
      dense = sample(2, std::clamp<std::size_t>(static_cast<std::size_t>(voxels) * kDensePerVoxel,
                                                4096, 400'000));
    } else {
      dense = surface_of_cloud(model.vertices, std::min(samples.spacing, 0.5F * step));
    }
    engine::orient_by_samples(samples.points, samples.normals, views, samples.spacing, dense.points,
                              dense.normals);
    kernels::SubsampleScratch scratch;
    kernels::subsample_by_normals(dense.points, dense.normals, step,
                                  options.normal_cluster_angle_deg * kRadiansPerDegree,
                                  model.ppf_points, model.ppf_normals, scratch);
  }
  stats.num_ppf_points = model.ppf_points.size();
  if (stats.num_ppf_points < 10 || stats.num_ppf_points > kMaxPpfPoints) {
    return bad_surface(source, fmt::format("{} sampled points at step {} (10 to {} can be used)",
                                           stats.num_ppf_points, step, kMaxPpfPoints));
  }
  {
    const StageTimer timer(stats.times, "table");
    if (const Result<void> built = build_table(source, options, step, model); !built)
      return built.error();
  }
  stats.num_ppf_entries = model.ppf.entries.size();
  return trained;
}

}  // namespace trivet
