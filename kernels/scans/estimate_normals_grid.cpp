#include "kernels/scans/estimate_normals_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "kernels/common/median.hpp"
#include "kernels/common/plane_fit.hpp"
#include "storage/common/precondition.hpp"
#include "storage/common/simd.hpp"
#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

// Eight adjacent pixels, as the compiler's vector type: ten sums of them stay in registers.
constexpr std::size_t kLanes = 8;
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

static_assert(PixelPoints::kMargin >= GridNormalOptions::kMaxWindow);

struct LanePoints {
  Lanes x, y, z;
};

struct LaneSums {
  Lanes n, x, y, z, xx, xy, xz, yy, yz, zz;
};

[[gnu::always_inline]] inline void load(const PixelPoints& pixels, std::size_t at,
                                        LanePoints& out) {
  std::memcpy(&out.x, &pixels.x[at], sizeof(Lanes));
  std::memcpy(&out.y, &pixels.y[at], sizeof(Lanes));
  std::memcpy(&out.z, &pixels.z[at], sizeof(Lanes));
}

// The squared distance to the nearer of two pixels, infinite if neither holds a point.
[[gnu::always_inline]] inline void nearer_of(const PixelPoints& pixels, const LanePoints& center,
                                             std::size_t one, std::size_t other, Lanes& out) {
  out = Lanes{} + std::numeric_limits<float>::infinity();
  for (const std::size_t at : {one, other}) {
    LanePoints p;
    load(pixels, at, p);
    const Lanes dx = p.x - center.x, dy = p.y - center.y, dz = p.z - center.z;
    const Lanes d2 = dx * dx + dy * dy + dz * dz;
    out = d2 < out ? d2 : out;  // false for NaN
  }
}

// The squared distance up to which neighbors count; 0 for a pixel without neighbors.
[[gnu::always_inline]] inline void squared_gate(const PixelPoints& pixels, const LanePoints& center,
                                                std::size_t at, float factor, Lanes& out) {
  const Lanes infinity = Lanes{} + std::numeric_limits<float>::infinity();
  Lanes h, v;
  nearer_of(pixels, center, at - 1, at + 1, h);
  nearer_of(pixels, center, at - pixels.stride, at + pixels.stride, v);
  const Lanes low = h < v ? h : v, high = h < v ? v : h;
  const Lanes cap = 9.0F * low;
  const Lanes footprint = high == infinity ? low : high < cap ? high : cap;
  out = footprint == infinity ? Lanes{} : footprint * (factor * factor);
}

// Sums over the window about the center: differences of close floats are exact or nearly so.
[[gnu::always_inline]] inline void sum_window(const PixelPoints& pixels, const LanePoints& center,
                                              std::size_t at, std::size_t window, const Lanes& gate,
                                              LaneSums& s) {
  const Lanes zero{};
  s = LaneSums{};
  for (std::size_t row = at - window * pixels.stride; row <= at + window * pixels.stride;
       row += pixels.stride) {
    for (std::size_t neighbor = row - window; neighbor <= row + window; ++neighbor) {
      LanePoints p;
      load(pixels, neighbor, p);
      Lanes x = p.x - center.x, y = p.y - center.y, z = p.z - center.z;
      const auto counts = x * x + y * y + z * z <= gate;  // false for NaN
      x = counts ? x : zero;
      y = counts ? y : zero;
      z = counts ? z : zero;
      s.n += counts ? zero + 1.0F : zero;
      s.x += x;
      s.y += y;
      s.z += z;
      s.xx += x * x;
      s.xy += x * y;
      s.xz += x * z;
      s.yy += y * y;
      s.yz += y * z;
      s.zz += z * z;
    }
  }
}

struct PlaneLanes {
  std::array<float, kLanes> x, y, z, residual, n;
};

[[gnu::always_inline]] inline void fit_lanes(const LaneSums& s, PlaneLanes& out) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  std::array<std::array<float, kLanes>, 10> sums;
  std::memcpy(&sums, &s, sizeof(s));
  for (std::size_t i = 0; i < kLanes; ++i) {
    const PlaneFit plane = fit_plane({sums[0][i], sums[1][i], sums[2][i], sums[3][i], sums[4][i],
                                      sums[5][i], sums[6][i], sums[7][i], sums[8][i], sums[9][i]});
    out.x[i] = plane.determined ? static_cast<float>(plane.x) : kNaN;
    out.y[i] = plane.determined ? static_cast<float>(plane.y) : kNaN;
    out.z[i] = plane.determined ? static_cast<float>(plane.z) : kNaN;
    out.residual[i] = static_cast<float>(plane.residual);
    out.n[i] = sums[0][i];
  }
}

}  // namespace

void arrange_pixels(const PixelGrid& grid, PointsView points, PixelPoints& out) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  out.width = grid.width;
  out.height = grid.height;
  out.stride =
      (grid.width + 3 * PixelPoints::kMargin - 1) / PixelPoints::kMargin * PixelPoints::kMargin;
  const std::size_t num_pixels = out.stride * (grid.height + 2 * PixelPoints::kMargin);
  out.x.assign(num_pixels, kNaN);
  out.y.assign(num_pixels, kNaN);
  out.z.assign(num_pixels, kNaN);
  for (std::size_t v = 0; v < grid.height; ++v) {
    check_stop();
    for (std::size_t u = 0; u < grid.width; ++u) {
      const std::int32_t index = grid.point_index[v * grid.width + u];
      if (index == PixelGrid::kNone) continue;
      const std::size_t at = out.at(u, v), i = static_cast<std::size_t>(index);
      out.x[at] = points.x[i];
      out.y[at] = points.y[i];
      out.z[at] = points.z[i];
    }
  }
}

TRIVET_SIMD_CLONES
void estimate_normals_grid(const GridScan& scan, const GridNormalOptions& options,
                           std::size_t first_row, std::size_t num_rows, NormalsSpan normals,
                           std::span<float> residuals) {
  const PixelGrid& grid = scan.grid;
  const PixelPoints& pixels = scan.pixels;
  TRIVET_REQUIRE(options.window >= 1 && options.window <= GridNormalOptions::kMaxWindow,
                 "a window within the margins");
  TRIVET_REQUIRE(first_row + num_rows <= pixels.height, "rows of the image");
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const float gate_factor = options.gate * static_cast<float>(options.window);
  const float min_points = static_cast<float>(std::max(options.min_points, 3U));
  const float min_cosine = std::cos(options.max_obliquity_rad);
  const Eigen::Vector3f sensor = scan.viewpoint;

  for (std::size_t v = first_row; v < first_row + num_rows; ++v) {
    const std::span<const std::int32_t> row(&grid.point_index[v * grid.width], grid.width);
    for (std::size_t u = 0; u < grid.width; u += kLanes) {
      const auto indices = row.subspan(u, std::min(kLanes, grid.width - u));
      if (std::ranges::all_of(indices, [](auto index) { return index == PixelGrid::kNone; })) {
        continue;
      }
      const std::size_t at = pixels.at(u, v);
      LanePoints center;
      Lanes gate;
      LaneSums sums;
      PlaneLanes planes;
      load(pixels, at, center);
      squared_gate(pixels, center, at, gate_factor, gate);
      sum_window(pixels, center, at, options.window, gate, sums);
      fit_lanes(sums, planes);

      // Orient each normal to the sensor and write it to its point.
      for (std::size_t lane = 0; lane < indices.size(); ++lane) {
        if (indices[lane] == PixelGrid::kNone) continue;
        const auto i = static_cast<std::size_t>(indices[lane]);
        const Eigen::Vector3f point{pixels.x[at + lane], pixels.y[at + lane], pixels.z[at + lane]};
        const Eigen::Vector3f normal{planes.x[lane], planes.y[lane], planes.z[lane]};
        const Eigen::Vector3f sight = sensor - point;
        const float cosine = normal.dot(sight) / sight.norm();
        const bool good = planes.n[lane] >= min_points && std::abs(cosine) >= min_cosine;
        normals.set(i, good ? Eigen::Vector3f(cosine < 0 ? -normal : normal)
                            : Eigen::Vector3f::Constant(kNaN));
        if (!residuals.empty()) residuals[i] = good ? planes.residual[lane] : kNaN;
      }
    }
  }
}

float estimate_scan_noise(std::span<const float> residuals, Column<float>& scratch) {
  constexpr float kNumPoints = 25;
  scratch.clear();
  scratch.reserve(residuals.size());
  for (const float residual : residuals) {
    if (!std::isnan(residual)) scratch.push_back(residual);
  }
  return median(std::span(scratch)) * std::sqrt(kNumPoints / (kNumPoints - 3));
}

}  // namespace trivet::kernels
