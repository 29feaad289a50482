#include "engine/common/check_extent.hpp"

#include <fmt/format.h>

namespace trivet::engine {
namespace {

constexpr float kSmallest = 1e-6F, kLargest = 1e9F;

}  // namespace

Result<void> check_extent(PointsView points, const std::string& name) {
  if (points.empty()) return {};
  Eigen::Vector3f low = points[0], high = points[0];
  for (std::size_t i = 1; i < points.size(); ++i) {
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
  }
  const float extent = (high - low).maxCoeff();
  const float farthest = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
  if (extent >= kSmallest && farthest <= kLargest) return {};
  return Error{ErrorCode::bad_data,
               fmt::format("{}: expected points that span {:g} or more, none beyond {:g}, found {} "
                           "that span {:g} up to {:g} from the origin; check the unit, or give "
                           "another file",
                           name, kSmallest, kLargest, points.size(), extent, farthest)};
}

}  // namespace trivet::engine
