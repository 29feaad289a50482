#include "engine/evaluation/degrade_scene.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "engine/common/parallel.hpp"
#include "kernels/common/median.hpp"
#include "kernels/simulation/add_noise.hpp"
#include "kernels/simulation/drop_points.hpp"
#include "kernels/surfaces/mesh_resolution.hpp"
#include "kernels/surfaces/subsample_approximate_voxel_grid.hpp"
#include "kernels/surfaces/subsample_grid_minimum.hpp"
#include "kernels/surfaces/subsample_local_maximum.hpp"
#include "kernels/surfaces/subsample_voxel_grid.hpp"
#include "storage/common/precondition.hpp"
#include "storage/data/file_pose.hpp"
#include "storage/formats/keep_points.hpp"

namespace trivet {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kGrain = 4096;  // points per task

bool degrades(DegradeOptions options) {
  if (options.subsampler == Subsampler::none) options.cell = DegradeOptions{}.cell;
  return options != DegradeOptions{};
}

/// Distances between the points of horizontally and vertically adjacent pixels.
Column<float> pixel_distances(const PixelGrid& grid, PointsView points) {
  Column<float> distances;
  distances.reserve(2 * points.size());
  const auto add = [&](std::size_t pixel, std::size_t neighbor) {
    const std::int32_t i = grid.point_index[pixel], j = grid.point_index[neighbor];
    if (i == PixelGrid::kNone || j == PixelGrid::kNone) return;
    distances.push_back(
        (points[static_cast<std::size_t>(i)] - points[static_cast<std::size_t>(j)]).norm());
  };
  for (std::size_t v = 0; v < grid.height; ++v) {
    for (std::size_t u = 0; u < grid.width; ++u) {
      const std::size_t pixel = v * grid.width + u;
      if (u + 1 < grid.width) add(pixel, pixel + 1);
      if (v + 1 < grid.height) add(pixel, pixel + grid.width);
    }
  }
  return distances;
}

Result<double> find_resolution(const Cloud& cloud) {
  if (cloud.grid) {
    Column<float> distances = pixel_distances(*cloud.grid, cloud.points);
    if (!distances.empty()) return static_cast<double>(kernels::median(std::span(distances)));
  }
  if (!cloud.triangles.empty()) return kernels::mean_edge_length(cloud.points, cloud.triangles);
  return kernels::mean_neighbor_distance(cloud.points);
}

/// Reduce a cloud to points and their viewpoint.
void scatter(const Vector3f& viewpoint, Cloud& cloud) {
  cloud.normals = {};
  cloud.triangles = {};
  cloud.grid.reset();
  cloud.camera.reset();
  cloud.viewpoint = viewpoint;
}

/// Apply disturb(points, first, out) to chunks of the points, in place.
template <class Disturb>
void for_points(PointsSpan points, Disturb&& disturb) {
  engine::for_chunks(points.size(), kGrain, [&](std::size_t first, std::size_t count) {
    const PointsSpan chunk = points.slice(first, count);
    disturb(chunk, first, chunk);
  });
}

void add_shot_noise(double share, std::uint64_t seed, PointsSpan points) {
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < points.size(); ++i) box.extend(PointsView(points)[i]);
  for_points(points, [&](PointsView in, std::size_t first, PointsSpan out) {
    kernels::add_shot_noise(in, box, share, seed, first, out);
  });
}

void thin_out(double share, std::uint64_t seed, Cloud& cloud) {
  Column<std::uint8_t> keep(cloud.points.size(), 1);
  engine::for_chunks(keep.size(), kGrain, [&](std::size_t first, std::size_t count) {
    kernels::keep_at_random(share, seed, first, std::span(keep).subspan(first, count));
  });
  keep_points(keep, cloud);
}

Points subsample(PointsView points, Subsampler subsampler, float cell) {
  Points out;
  Column<std::uint32_t> indices;
  kernels::SubsampleScratch scratch;
  switch (subsampler) {
    case Subsampler::none:
      break;
    case Subsampler::voxel_grid:
      kernels::subsample_voxel_grid(points, cell, out, scratch);
      break;
    case Subsampler::approximate_voxel_grid:
      kernels::subsample_approximate_voxel_grid(points, cell, out);
      break;
    case Subsampler::grid_minimum:
      kernels::subsample_grid_minimum(points, cell, indices, scratch);
      break;
    case Subsampler::local_maximum:
      kernels::subsample_local_maximum(points, cell, indices, scratch);
      break;
  }
  for (const std::uint32_t i : indices) out.push_back(points[i]);
  return out;
}

}  // namespace

Result<void> degrade_scene(Cloud& cloud, const DegradeOptions& options, float diameter,
                           std::uint64_t seed) {
  TRIVET_REQUIRE(diameter > 0, "what noise and cells are counted in");
  if (!degrades(options)) return {};
  float resolution = 0;
  if (options.noise > 0 || options.ray_noise > 0) {
    TRIVET_TRY_ASSIGN(const double found, find_resolution(cloud));
    resolution = static_cast<float>(found);
  }
  const Vector3f viewpoint =
      cloud.camera
          ? Vector3f::Zero()
          : cloud.viewpoint.value_or(in_cloud_frame(Eigen::Vector3d::Zero(), cloud.offset));
  scatter(viewpoint, cloud);

  if (options.ray_noise > 0) {
    for_points(cloud.points, [&](PointsView in, std::size_t first, PointsSpan out) {
      kernels::add_ray_noise(in, viewpoint, options.ray_noise * resolution, seed, first, out);
    });
  }
  const float sigma = std::hypot(options.noise * resolution, options.noise_diameters * diameter);
  if (sigma > 0) {
    for_points(cloud.points, [&](PointsView in, std::size_t first, PointsSpan out) {
      kernels::add_gaussian_noise(in, sigma, seed, first, out);
    });
  }
  if (options.shot_noise > 0)
    add_shot_noise(static_cast<double>(options.shot_noise), seed, cloud.points);
  if (options.keep < 1) thin_out(static_cast<double>(options.keep), seed, cloud);
  if (options.subsampler != Subsampler::none)
    cloud.points = subsample(cloud.points, options.subsampler, options.cell * diameter);
  return {};
}

}  // namespace trivet
