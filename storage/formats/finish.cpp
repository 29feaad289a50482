#include "storage/formats/finish.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <vector>

#include "storage/common/stop.hpp"
#include "storage/formats/keep_points.hpp"
#include "storage/formats/used_vertices.hpp"

namespace trivet::formats {
namespace {

constexpr float kLargestCoordinate = 1e7F;
/// Smallest extent relative to the distance from the origin; a float's rounding is 6e-8 of it.
/// Poses rotate models about their origin, so rounding of the positions must be small relative to
/// the model.
constexpr float kSmallestExtent = 1e-5F, kSmallestModel = 1e-3F;

void drop_invalid(Cloud& cloud) {
  std::vector<std::uint8_t> is_finite(cloud.points.size());
  StopCheck check_stop(1 << 18);
  for (std::size_t i = 0; i < is_finite.size(); ++i) {
    check_stop();
    is_finite[i] = cloud.points[i].allFinite();
    cloud.num_invalid += is_finite[i] == 0;
  }
  if (cloud.num_invalid > 0) keep_points(is_finite, cloud);
}

/// Vertices of a model that lie on no face count neither into its size nor its symmetry. If all
/// faces have no area, as in clouds of some programs, the points are a cloud.
void drop_unused(Cloud& cloud) {
  const UsedVertices used = find_used_vertices(cloud.points, cloud.triangles);
  if (used.num_unused == 0) return;
  cloud.num_without_area = used.num_without_area;
  if (used.num_unused == cloud.points.size()) {
    cloud.triangles = {};
    return;
  }
  cloud.num_unused = used.num_unused;
  keep_points(used.marks, cloud);
}

Result<void> check_range(const Cloud& cloud, const Input& input) {
  const PointsView points = cloud.points;
  Eigen::AlignedBox3f box(points[0]);
  StopCheck check_stop(1 << 18);
  for (std::size_t i = 1; i < points.size(); ++i) {
    check_stop();
    box.extend(points[i]);
  }
  const float distance = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  const float extent = box.sizes().maxCoeff();
  if (distance > kLargestCoordinate) {
    return input.refuse(
        fmt::format("expected coordinates up to {:g}, found {:g}; give the file in "
                    "meters or millimeters near its own origin",
                    kLargestCoordinate, distance));
  }
  if (cloud.offset.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    return input.refuse(
        fmt::format("expected coordinates up to {:g}, found some near ({:g}, {:g}, {:g})",
                    kMaxCoordinate, cloud.offset.x(), cloud.offset.y(), cloud.offset.z()));
  }
  const float smallest = input.options.keep_origin ? kSmallestModel : kSmallestExtent;
  if (points.size() > 1 && extent < smallest * distance) {
    const Eigen::Vector3f middle = (box.min() + box.max()) / 2;
    return input.refuse(fmt::format(
        "the points span {:g} at {:g} from the origin, of which poses would speak: too far for "
        "floats; subtract about ({:.0f}, {:.0f}, {:.0f}) from all coordinates",
        extent, distance, middle.x(), middle.y(), middle.z()));
  }
  return {};
}

}  // namespace

Result<Cloud> finish(Cloud cloud, const Input& input) {
  const std::size_t num_read = cloud.points.size();
  drop_invalid(cloud);
  if (cloud.points.empty() && cloud.grid) return cloud;  // the sensor measured nothing
  if (num_read == 0) return input.refuse("expected at least one point, found none");
  if (cloud.points.empty()) {
    return input.refuse(
        fmt::format("expected at least one point, found {} of which none is finite", num_read));
  }
  if (input.options.keep_origin && !cloud.triangles.empty()) drop_unused(cloud);
  TRIVET_TRY(check_range(cloud, input));
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    if (!cloud.normals[i].allFinite()) cloud.normals.set(i, Eigen::Vector3f::Zero());
  }
  return cloud;
}

}  // namespace trivet::formats
