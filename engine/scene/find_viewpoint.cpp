#include "engine/scene/find_viewpoint.hpp"

#include <fmt/format.h>

#include <cmath>

#include "storage/data/bounding_box.hpp"
#include "storage/data/file_pose.hpp"

namespace trivet::engine {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Maximum rounding error of distances, relative to the spacing of the points.
constexpr double kMostRounding = 1.0 / 64, kFloatRounding = 6e-8;

/// Extent of points, and their approximate spacing if they cover a surface.
struct Spread {
  Vector3d middle{0, 0, 0};
  double extent = 0, spacing = 0;
};

Spread spread_of(PointsView points) {
  const Eigen::AlignedBox3f box = bounding_box(points);
  const auto extent = static_cast<double>(box.sizes().maxCoeff());
  return {((box.min() + box.max()) / 2).cast<double>(), extent,
          extent / std::sqrt(static_cast<double>(points.size()))};
}

}  // namespace

Result<Vector3f> find_viewpoint(const Cloud& cloud, const std::optional<Vector3d>& given,
                                const std::string& name) {
  const Vector3f viewpoint = given             ? in_cloud_frame(*given, cloud.offset)
                             : cloud.viewpoint ? *cloud.viewpoint
                                               : in_cloud_frame(Vector3d::Zero(), cloud.offset);
  if (cloud.offset.isZero(0) || cloud.points.empty()) return viewpoint;
  const Spread spread = spread_of(cloud.points);
  const double distance = (viewpoint.cast<double>() - spread.middle).norm();
  if (distance * kFloatRounding <= kMostRounding * spread.spacing) return viewpoint;
  const Vector3d middle = spread.middle + cloud.offset;
  return Error{
      ErrorCode::bad_data,
      fmt::format(
          "{}: the points lie around ({:.10g}, {:.10g}, {:.10g}) and span {:.4g}, {:.4g} "
          "from the sensor: too far to determine what it sees of them; give its position in "
          "the file's frame with --viewpoint",
          name, middle.x(), middle.y(), middle.z(), spread.extent, distance)};
}

}  // namespace trivet::engine
