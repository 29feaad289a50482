#include "engine/common/check_extent.hpp"

#include <fmt/format.h>

#include "storage/data/bounding_box.hpp"

namespace trivet::engine {
namespace {

constexpr float kSmallest = 1e-6F, kLargest = 1e9F;

}  // namespace

Result<void> check_extent(PointsView points, const std::string& name) {
  if (points.empty()) return {};
  const Eigen::AlignedBox3f box = bounding_box(points);
  const float extent = box.sizes().maxCoeff();
  const float farthest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  if (extent >= kSmallest && farthest <= kLargest) return {};
  return Error{ErrorCode::bad_data,
               fmt::format("{}: expected points that span {:g} or more, none beyond {:g}, found {} "
                           "that span {:g} up to {:g} from the origin; check the unit, or give "
                           "another file",
                           name, kSmallest, kLargest, points.size(), extent, farthest)};
}

}  // namespace trivet::engine
