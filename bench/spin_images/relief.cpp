#include "spin_images/relief.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "descriptors/degrade_mesh.hpp"
#include "descriptors/descriptors.hpp"
#include "kernels/common/counter_random.hpp"
#include "kernels/surfaces/mesh_resolution.hpp"

namespace trivet::bench {
namespace {

constexpr std::uint32_t kSide = 150;

/// Waves in random directions, from 8 to 60 vertices long.
Mesh make_relief() {
  const auto height = [](double x, double y) {
    double sum = 0;
    for (std::uint64_t k = 0; k < 30; ++k) {
      kernels::CounterRandom random(7, 0, k);
      const double turn = random.uniform(0, 2 * std::numbers::pi);
      const double length = 8 * std::pow(7.5, random.uniform());
      const double along = std::cos(turn) * x + std::sin(turn) * y;
      sum += 0.03 * length * std::sin(2 * std::numbers::pi * (along / length + random.uniform()));
    }
    return sum;
  };
  Mesh mesh;
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      mesh.vertices.push_back(
          {static_cast<float>(i), static_cast<float>(j), static_cast<float>(height(i, j))});
      if (i + 1 == kSide || j + 1 == kSide) continue;
      const std::uint32_t k = j * kSide + i;
      mesh.triangles.push_back(k, k + 1, k + kSide);
      mesh.triangles.push_back(k + 1, k + kSide + 1, k + kSide);
    }
  }
  const double resolution = kernels::mean_edge_length(mesh.vertices, mesh.triangles);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    mesh.vertices.set(i, mesh.vertices[i] / static_cast<float>(resolution));
  return mesh;
}

/// The relief unchanged or as a scan; vertices keep their numbers, and so do keypoints.
KeypointSurface make_surface(const Degradation& how, const Pose& T_scene_relief) {
  const Mesh mesh = make_relief();
  return sample_surface(degrade_mesh(mesh, how, 1, T_scene_relief, 5),
                        draw_vertices(mesh, kNumKeypoints, 1), 1);
}

}  // namespace

const KeypointSurface& relief() {
  static const KeypointSurface surface = make_surface({.name = "none"}, Pose::Identity());
  return surface;
}

const KeypointSurface& noisy_relief() {
  static const KeypointSurface surface =
      make_surface({.name = "noise", .noise = 0.3F}, random_pose(9, 100));
  return surface;
}

const Column<float>& relief_images() {
  static const Column<float> images = describe(descriptors().front(), relief());
  return images;
}

const Column<float>& noisy_images() {
  static const Column<float> images = describe(descriptors().front(), noisy_relief());
  return images;
}

const PcaBasis& relief_basis() {
  static const PcaBasis basis =
      kernels::find_components(relief_images(), descriptors().front().size, 60);
  return basis;
}

void report_nearest_right(benchmark::State& state, const Column<float>& of_relief,
                          const Column<float>& of_scan) {
  FeaturePool pool;
  pool.dimension = of_relief.size() / relief().keypoints.size();
  pool.features = of_relief;
  pool.models.assign(relief().keypoints.size(), 0);
  pool.keypoints = relief().keypoints;
  pool.reaches = {0.5F * relief().radius};
  const auto matches = match_with(pool, of_scan, 0, relief().keypoints);
  state.counters["nearest_right"] =
      static_cast<double>(std::ranges::count_if(matches, &ScoredOutcome::right)) /
      static_cast<double>(matches.size());
}

}  // namespace trivet::bench
