#include "descriptors/keypoint_surface.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/common/parallel.hpp"
#include "kernels/common/counter_random.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "kernels/spin_images/support.hpp"
#include "kernels/surfaces/estimate_normals.hpp"
#include "kernels/surfaces/sample_mesh.hpp"
#include "kernels/surfaces/subsample_by_normals.hpp"
#include "storage/data/neighborhoods.hpp"

namespace trivet::bench {
namespace {

constexpr double kSamplesPerPoint = 4;
constexpr float kNormalRadius = 4;          // [resolutions]
constexpr float kShareRadius = 2.5F;        // [resolutions]
constexpr float kNormalClusterRad = 0.52F;  // the value of engine/training/describe_model

/// Normals at `queries` of planes fitted to the surrounding samples, oriented like their faces.
Normals fit_normals(PointsView samples, NormalsView face_normals, PointsView queries,
                    float radius) {
  const kernels::VoxelHash grid(samples, radius);
  Normals normals(queries.size());
  engine::for_chunks(queries.size(), 1024, [&](std::size_t first, std::size_t count) {
    const PointsView some = queries.slice(first, count);
    Neighborhoods rows;
    rows.offsets.assign(count + 1, 0);
    kernels::count_radius_neighbors(grid, some, radius, std::span(rows.offsets).subspan(1));
    std::inclusive_scan(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
    rows.indices.resize(rows.offsets.back());
    kernels::fill_radius_neighbors(grid, some, radius, rows.offsets, rows.indices);
    const NormalsSpan out = normals.span().slice(first, count);
    kernels::estimate_normals(samples, rows, out);
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f normal = normals[first + i];
      Eigen::Vector3f side = Eigen::Vector3f::Zero();
      for (const std::uint32_t k : rows.view().row(i)) side += face_normals[k];
      if (normal.dot(side) < 0) out.set(i, -normal);
    }
  });
  return normals;
}

}  // namespace

KeypointSurface sample_surface(Mesh mesh, std::span<const std::uint32_t> keypoints,
                               float resolution) {
  std::vector<double> sums(mesh.triangles.size());
  const double area = kernels::sum_areas(mesh.vertices, mesh.triangles, sums);
  const double cell = static_cast<double>(resolution);
  const auto n = static_cast<std::size_t>(kSamplesPerPoint * area / (cell * cell));
  Points samples(n);
  Normals face_normals(n);
  engine::for_chunks(n, 1024, [&](std::size_t first, std::size_t count) {
    kernels::sample_mesh(
        {mesh.vertices, mesh.triangles, sums}, 3, first, n,
        {samples.span().slice(first, count), face_normals.span().slice(first, count)});
  });

  KeypointSurface out;
  out.radius = kSupport * resolution;
  for (const std::uint32_t i : keypoints) out.keypoints.push_back(mesh.vertices[i]);
  const float radius = kNormalRadius * resolution;
  const Normals normals = fit_normals(samples, face_normals, samples, radius);
  out.keypoint_normals = fit_normals(samples, face_normals, out.keypoints, radius);
  Normals unused;
  kernels::SubsampleScratch scratch;
  kernels::subsample_by_normals({samples, normals}, resolution, kNormalClusterRad, out.points,
                                unused, scratch);
  const float share = kShareRadius * resolution;
  const kernels::VoxelHash grid(out.points, share);
  out.areas.resize(out.points.size());
  engine::for_chunks(out.points.size(), 1024, [&](std::size_t first, std::size_t count) {
    kernels::share_areas(grid, out.points.view().slice(first, count), share,
                         std::span(out.areas).subspan(first, count));
  });
  out.mesh = std::move(mesh);
  return out;
}

std::vector<std::uint32_t> draw_vertices(const Mesh& mesh, std::size_t count, std::uint64_t seed) {
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
  for (const auto* corner : {&mesh.triangles.a, &mesh.triangles.b, &mesh.triangles.c})
    for (const std::uint32_t i : *corner) used[i] = 1;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> drawn;
  for (std::uint32_t i = 0; i < used.size(); ++i)
    if (used[i] != 0) drawn.emplace_back(kernels::CounterRandom(seed, 0, i).next(), i);
  std::ranges::sort(drawn);
  drawn.resize(std::min(count, drawn.size()));
  std::vector<std::uint32_t> vertices;
  for (const auto& [number, i] : drawn) vertices.push_back(i);
  std::ranges::sort(vertices);
  return vertices;
}

}  // namespace trivet::bench
