#include "kernels/surfaces/visibility.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "storage/common/precondition.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

struct Views {
  alignas(64) std::array<float, kNumViews> x, y, z;
};

const Views& views() noexcept {
  static const Views table = [] {
    Views made{};
    const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
    for (std::size_t d = 0; d < kNumViews; ++d) {
      const auto index = static_cast<double>(d);
      const double z = 1 - (2 * index + 1) / static_cast<double>(kNumViews);
      const double r = std::sqrt(1 - z * z);
      made.x[d] = static_cast<float>(r * std::cos(golden_angle * index));
      made.y[d] = static_cast<float>(r * std::sin(golden_angle * index));
      made.z[d] = static_cast<float>(z);
    }
    return made;
  }();
  return table;
}

using Cosines = std::array<float, kNumViews>;

TRIVET_SIMD_CLONES
void dot_all(const Views& table, const Eigen::Vector3f& v, Cosines& out) {
  const float vx = v.x(), vy = v.y(), vz = v.z();
  TRIVET_SIMD_LOOP
  for (std::size_t d = 0; d < kNumViews; ++d)
    out[d] = table.x[d] * vx + table.y[d] * vy + table.z[d] * vz;
}

void dot_views(const Eigen::Vector3f& v, Cosines& out) { dot_all(views(), v, out); }

/// In lanes, since the order does not affect a maximum, which the compiler may not assume.
TRIVET_SIMD_CLONES
float largest_of(const Cosines& cosines) {
  std::array<float, 16> lanes;
  lanes.fill(-std::numeric_limits<float>::infinity());
  for (std::size_t d = 0; d < kNumViews; d += lanes.size()) {
    for (std::size_t k = 0; k < lanes.size(); ++k)
      lanes[k] = lanes[k] < cosines[d + k] ? cosines[d + k] : lanes[k];
  }
  return *std::max_element(lanes.begin(), lanes.end());
}

/// All views, in runs of neighbors: each next one is the nearest to those already in its packet.
const std::array<std::size_t, kNumViews>& packed_views() {
  static const auto order = [] {
    std::array<std::size_t, kNumViews> made{};
    std::array<bool, kNumViews> used{};
    Eigen::Vector3f sum = view_direction(0);
    for (std::size_t k = 0; k < kNumViews; ++k) {
      float nearest = -std::numeric_limits<float>::infinity();
      for (std::size_t d = 0; d < kNumViews; ++d) {
        const float along = sum.dot(view_direction(d));
        if (used[d] || along <= nearest) continue;
        nearest = along;
        made[k] = d;
      }
      used[made[k]] = true;
      const Eigen::Vector3f last = view_direction(made[k]);
      sum = (k + 1) % RayScene::kPacket == 0 ? last : Eigen::Vector3f(sum + last);
    }
    return made;
  }();
  return order;
}

/// Free views of one side of a point; cosines times `side` are those with that side's normal.
ViewMask free_views(const RayScene& scene, const Eigen::Vector3f& origin, const Cosines& cosines,
                    float side, const ViewMask& wanted) {
  std::array<std::size_t, RayScene::kPacket> packet;
  std::array<float, RayScene::kPacket> x, y, z;
  std::size_t n = 0;
  ViewMask mask{};
  const auto trace = [&] {
    const std::uint32_t occluded = scene.occluded(
        origin, PointsView{std::span(x).first(n), std::span(y).first(n), std::span(z).first(n)});
    for (std::size_t k = 0; k < n; ++k) {
      if ((occluded >> k & 1U) == 0) mask[packet[k] / 64] |= std::uint64_t{1} << (packet[k] % 64);
    }
    n = 0;
  };
  const Views& table = views();
  for (const std::size_t d : packed_views()) {
    if (!(side * cosines[d] > kMinViewCosine) || !is_visible(wanted, d)) continue;
    packet[n] = d;
    x[n] = table.x[d];
    y[n] = table.y[d];
    z[n] = table.z[d];
    if (++n == packet.size()) trace();
  }
  if (n > 0) trace();
  return mask;
}

int count_views(const ViewMask& mask) {
  int count = 0;
  for (const std::uint64_t word : mask) count += std::popcount(word);
  return count;
}

}  // namespace

Eigen::Vector3f view_direction(std::size_t d) noexcept {
  assert(d < kNumViews && "no such view");
  const Views& table = views();
  return {table.x[d], table.y[d], table.z[d]};
}

std::size_t nearest_view(const Eigen::Vector3f& direction) noexcept {
  Cosines cosines;
  dot_views(direction, cosines);
  const float largest = largest_of(cosines);
  const auto first = std::find(cosines.begin(), cosines.end(), largest);
  return first == cosines.end() ? 0 : static_cast<std::size_t>(first - cosines.begin());
}

void compute_views(const RayScene& scene, PointsView points, NormalsView normals, float offset,
                   const ViewMask& wanted, std::span<ViewMask> masks) {
  TRIVET_REQUIRE(normals.size() == points.size() && masks.size() == points.size(),
                 "one each a point");
  Cosines cosines;
  for (std::size_t i = 0; i < points.size(); ++i) {
    dot_views(normals[i], cosines);
    masks[i] = free_views(scene, points[i] + offset * normals[i], cosines, 1, wanted);
  }
}

void orient_outward(const RayScene& scene, PointsView points, NormalsSpan normals, float offset,
                    std::span<ViewMask> masks) {
  TRIVET_REQUIRE(normals.size() == points.size() && masks.size() == points.size(),
                 "one each a point");
  const NormalsView given = normals;
  Cosines cosines;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f normal = given[i];
    dot_views(normal, cosines);
    masks[i] = free_views(scene, points[i] + offset * normal, cosines, 1, kAllViews);
    // If this side has so many free views that no other side could have twice as many, half of the
    // rays are saved.
    const auto behind =
        std::count_if(cosines.begin(), cosines.end(), [](float c) { return -c > kMinViewCosine; });
    if (2 * count_views(masks[i]) >= behind) continue;
    const ViewMask other = free_views(scene, points[i] - offset * normal, cosines, -1, kAllViews);
    if (count_views(other) > 2 * count_views(masks[i])) {
      masks[i] = other;
      normals.set(i, -normal);
    }
  }
}

}  // namespace trivet::kernels
