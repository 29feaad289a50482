#include "storage/formats/keep_points.hpp"

#include <limits>
#include <utility>
#include <vector>

#include "storage/common/precondition.hpp"

namespace trivet {
namespace {

constexpr std::uint32_t kDropped = std::numeric_limits<std::uint32_t>::max();

void move_up(std::span<const std::uint32_t> index, std::size_t num_kept, Points& points) {
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i] != kDropped) points.set(index[i], points[i]);
  }
  points.resize(num_kept);
}

}  // namespace

void keep_points(std::span<const std::uint8_t> keep, Cloud& cloud) {
  TRIVET_REQUIRE(keep.size() == cloud.points.size(), "one mark a point");
  std::size_t num_kept = 0;
  std::vector<std::uint32_t> index(keep.size(), kDropped);
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] != 0) index[i] = static_cast<std::uint32_t>(num_kept++);
  }

  move_up(index, num_kept, cloud.points);
  if (!cloud.normals.empty()) move_up(index, num_kept, cloud.normals);
  if (!cloud.intensity.empty()) {
    for (std::size_t i = 0; i < index.size(); ++i) {
      if (index[i] != kDropped) cloud.intensity[index[i]] = cloud.intensity[i];
    }
    cloud.intensity.resize(num_kept);
  }
  Triangles kept;
  for (std::size_t t = 0; t < cloud.triangles.size(); ++t) {
    const auto a = index[cloud.triangles.a[t]], b = index[cloud.triangles.b[t]];
    const auto c = index[cloud.triangles.c[t]];
    if (a != kDropped && b != kDropped && c != kDropped) kept.push_back(a, b, c);
  }
  cloud.triangles = std::move(kept);
  if (!cloud.grid) return;
  for (std::int32_t& point : cloud.grid->point_index) {
    if (point == PixelGrid::kNone) continue;
    const std::uint32_t moved = index[static_cast<std::size_t>(point)];
    point = moved == kDropped ? PixelGrid::kNone : static_cast<std::int32_t>(moved);
  }
}

}  // namespace trivet
