#include "storage/formats/finish.hpp"

#include <fmt/format.h>

#include <limits>
#include <vector>

namespace trivet::formats {
namespace {

constexpr float kLargestCoordinate = 1e7F;
constexpr float kSmallestExtent = 1e-5F;  ///< beside the distance; float steps are 6e-8 of it

constexpr std::uint32_t kDropped = std::numeric_limits<std::uint32_t>::max();

/// New index of each point, kDropped for those that are not finite.
std::vector<std::uint32_t> number_finite(PointsView points, std::size_t& num_kept) {
  std::vector<std::uint32_t> index(points.size(), kDropped);
  num_kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite()) index[i] = static_cast<std::uint32_t>(num_kept++);
  }
  return index;
}

void keep(std::span<const std::uint32_t> index, std::size_t num_kept, Points& points) {
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i] != kDropped) points.set(index[i], points[i]);
  }
  points.resize(num_kept);
}

void drop_invalid(Cloud& cloud) {
  std::size_t num_kept = 0;
  const auto index = number_finite(cloud.points, num_kept);
  cloud.num_invalid = index.size() - num_kept;
  if (cloud.num_invalid == 0) return;

  keep(index, num_kept, cloud.points);
  if (!cloud.normals.empty()) keep(index, num_kept, cloud.normals);
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

Result<void> check_range(PointsView points, const Input& input) {
  Eigen::Vector3f low = points[0], high = points[0];
  for (std::size_t i = 1; i < points.size(); ++i) {
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
  }
  const float distance = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
  const float extent = (high - low).maxCoeff();
  if (distance > kLargestCoordinate) {
    return input.refuse(
        fmt::format("expected coordinates up to {:g}, found {:g}; give the file in "
                    "metres or millimetres near its own origin",
                    kLargestCoordinate, distance));
  }
  if (points.size() > 1 && extent < kSmallestExtent * distance) {
    return input.refuse(
        fmt::format("the points span {:g} at {:g} from the origin: float cannot tell "
                    "them apart; subtract a constant offset from all coordinates",
                    extent, distance));
  }
  return {};
}

}  // namespace

Result<Cloud> finish(Cloud cloud, const Input& input) {
  const std::size_t num_read = cloud.points.size();
  drop_invalid(cloud);
  if (cloud.points.empty()) {
    return input.refuse(
        fmt::format("expected at least one point, found {} of which none is finite", num_read));
  }
  if (auto checked = check_range(cloud.points, input); !checked) return checked.error();
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    if (!cloud.normals[i].allFinite()) cloud.normals.set(i, Eigen::Vector3f::Zero());
  }
  return cloud;
}

}  // namespace trivet::formats
