#include "storage/formats/faces.hpp"

#include <fmt/format.h>

#include <utility>

#include "storage/formats/split_polygon.hpp"

namespace trivet::formats {
namespace {

/// Limits on tested corners per corner of a file's faces, and for any file. Faces of 200,000
/// corners, every other one reflex, are split within two thirds of it.
constexpr std::uint64_t kStepsPerCorner = 1000, kFewSteps = 1'000'000;

}  // namespace

void Faces::add(std::uint32_t vertex) {
  ++num_corners_;
  if (num_corners_ == 1) first_ = vertex;
  if (num_corners_ >= 3) triangles_.push_back(first_, previous_, vertex);
  if (num_corners_ == 4) polygons_.push_back({first_triangle_, 1});
  if (num_corners_ >= 4) ++polygons_.back().num_triangles;
  previous_ = vertex;
}

Result<void> Faces::put_into(Cloud& cloud, const Input& input) && {
  SplitScratch scratch;
  std::uint64_t steps = kFewSteps;
  for (const Polygon& polygon : polygons_) steps += kStepsPerCorner * (polygon.num_triangles + 2);
  std::vector<std::uint32_t> corners;
  std::vector<CornerTriangle> split;
  for (const auto& [first, count] : polygons_) {
    corners.assign({triangles_.a[first], triangles_.b[first]});
    for (std::size_t t = first; t < first + count; ++t) corners.push_back(triangles_.c[t]);
    split.resize(count);
    if (!split_polygon(cloud.points, corners, scratch, steps, split)) {
      return input.refuse(
          fmt::format("concave faces, one of {} corners, need more than {} steps a corner to be "
                      "split; triangulate the mesh first",
                      corners.size(), kStepsPerCorner));
    }
    for (std::size_t t = 0; t < count; ++t) {
      triangles_.a[first + t] = corners[split[t].a];
      triangles_.b[first + t] = corners[split[t].b];
      triangles_.c[first + t] = corners[split[t].c];
    }
  }

  if (cloud.triangles.empty()) {
    cloud.triangles = std::move(triangles_);
    return {};
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    cloud.triangles.push_back(triangles_.a[t], triangles_.b[t], triangles_.c[t]);
  }
  return {};
}

}  // namespace trivet::formats
