#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "kernels/meshing/boundary_share.hpp"
#include "kernels/meshing/triangulate_greedy.hpp"
#include "kernels/meshing/triangulate_grid.hpp"
#include "kernels/scans/estimate_normals_grid.hpp"
#include "meshing/mesh_input.hpp"
#include "rows.hpp"

namespace trivet::bench {
namespace {

constexpr float kBridge = 0.1F;  // [m]; the ball is farther from the walls

float sphere_spacing(std::size_t n) {
  return std::sqrt(4 * std::numbers::pi_v<float> / static_cast<float>(n));
}

struct EdgeShares {
  double crowded = 0, twisted = 0;
};

/// The fraction of edges in three or more triangles, and the fraction that two triangles traverse
/// in the same direction, so that they face opposite sides.
EdgeShares edge_shares(const Triangles& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t c[] = {triangles.a[t], triangles.b[t], triangles.c[t]};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = c[k], j = c[(k + 1) % 3];
      auto& [forth, back] = edges[{std::min(i, j), std::max(i, j)}];
      ++(i < j ? forth : back);
    }
  }
  EdgeShares shares;
  for (const auto& [edge, count] : edges) {
    const auto [forth, back] = count;
    shares.crowded += forth + back > 2;
    shares.twisted += forth + back == 2 && forth != back;
  }
  const auto n = static_cast<double>(edges.size());
  return {shares.crowded / n, shares.twisted / n};
}

const bool kGreedy = [] {
  auto* row = benchmark::RegisterBenchmark("mesh_greedy/ours", [](benchmark::State& state) {
    const OrientedPoints& sphere = noisy_sphere(state.range(0));
    Triangles triangles;
    for (auto _ : state) {
      triangles = *kernels::triangulate_greedy(sphere.points, sphere.normals);
    }
    state.SetItemsProcessed(state.iterations() * state.range(0));
    report_sphere(state, sphere, triangles);
  });
  row->Unit(benchmark::kMillisecond);
  for (const std::int64_t n : kMeshPoints) row->Arg(n);
  return true;
}();

// Starts from points alone: the row includes the noise measurement.
const bool kGrid = [] {
  auto* row = add_row("mesh_grid/ours", [](benchmark::State& state, const Scan& scan) {
    const std::size_t n = scan.points.size();
    kernels::PixelPoints pixels;
    Normals normals(n);
    Column<float> residuals(n), noise, scratch;
    Triangles triangles;
    for (auto _ : state) {
      kernels::arrange_pixels(scan.grid, scan.points, pixels);
      kernels::estimate_normals_grid({scan.grid, pixels, {0, 0, 0}}, {.window = 2}, 0,
                                     scan.grid.height, normals, residuals);
      noise.assign(n, kernels::estimate_scan_noise(residuals, scratch));
      triangles = kernels::triangulate_grid(scan.grid, scan.points, {0, 0, 0}, noise);
    }
    report_scan(state, scan, triangles);
  });
  for (const std::int64_t width : kMeshWidths) row->Arg(width);
  return true;
}();

}  // namespace

const OrientedPoints& noisy_sphere(std::int64_t num_points) {
  static std::map<std::int64_t, OrientedPoints> spheres;
  const auto [entry, is_new] = spheres.try_emplace(num_points);
  if (is_new) {
    std::mt19937 random(1);
    std::normal_distribution<float> normal;
    const float noise = 0.2F * sphere_spacing(static_cast<std::size_t>(num_points));
    for (std::int64_t i = 0; i < num_points; ++i) {
      const float x = normal(random), y = normal(random), z = normal(random);
      const Eigen::Vector3f d = Eigen::Vector3f(x, y, z).normalized();
      entry->second.normals.push_back(d);
      entry->second.points.push_back((1 + noise * normal(random)) * d);
    }
  }
  return entry->second;
}

void report_mesh(benchmark::State& state, std::size_t num_points, const Triangles& triangles) {
  std::vector<std::uint8_t> is_used(num_points, 0);
  for (const auto* corners : {&triangles.a, &triangles.b, &triangles.c}) {
    for (const std::uint32_t v : *corners) is_used[v] = 1;
  }
  const auto n = static_cast<double>(num_points);
  state.counters["triangles_a_point"] = static_cast<double>(triangles.size()) / n;
  state.counters["used_share"] = static_cast<double>(std::ranges::count(is_used, 1)) / n;
  state.counters["open_edges"] = kernels::boundary_share(triangles);
  const EdgeShares shares = edge_shares(triangles);
  state.counters["crowded_edges"] = shares.crowded;
  state.counters["twisted_edges"] = shares.twisted;
}

void report_sphere(benchmark::State& state, const OrientedPoints& sphere,
                   const Triangles& triangles) {
  report_mesh(state, sphere.points.size(), triangles);
  double sum = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Eigen::Vector3f middle = (sphere.points[triangles.a[t]] + sphere.points[triangles.b[t]] +
                                    sphere.points[triangles.c[t]]) /
                                   3;
    sum += std::pow(static_cast<double>(middle.norm() - 1), 2);
  }
  state.counters["rms_spacings"] = std::sqrt(sum / static_cast<double>(triangles.size())) /
                                   static_cast<double>(sphere_spacing(sphere.points.size()));
}

void report_scan(benchmark::State& state, const Scan& scan, const Triangles& triangles) {
  report_mesh(state, scan.points.size(), triangles);
  std::size_t num_bridges = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Eigen::Vector3f a = scan.points[triangles.a[t]], b = scan.points[triangles.b[t]],
                          c = scan.points[triangles.c[t]];
    num_bridges += std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()}) > kBridge;
  }
  state.counters["bridges"] = static_cast<double>(num_bridges);
}

}  // namespace trivet::bench
