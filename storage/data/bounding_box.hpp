/// The axis-aligned bounding box of points.
#pragma once

#include <Eigen/Geometry>

#include "storage/common/precondition.hpp"
#include "storage/data/points.hpp"

namespace trivet {

/// The smallest axis-aligned box around n >= 1 points.
inline Eigen::AlignedBox3f bounding_box(PointsView points) {
  TRIVET_REQUIRE(!points.empty(), "a point to lay a box around");
  Eigen::AlignedBox3f box(points[0]);
  for (std::size_t i = 1; i < points.size(); ++i) box.extend(points[i]);
  return box;
}

}  // namespace trivet
