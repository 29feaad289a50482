#include "storage/formats/positions.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "storage/files/text.hpp"

namespace trivet::formats {
namespace {

using Eigen::Vector3d;

/// The bounding box of the finite positions.
Eigen::AlignedBox3d box_of(const Positions& positions) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vector3d p(positions.x[i], positions.y[i], positions.z[i]);
    if (p.allFinite()) box.extend(p);
  }
  return box;
}

/// Zero along axes where floats are precise enough.
Vector3d choose_offset(const Eigen::AlignedBox3d& box) {
  const double extent = box.sizes().maxCoeff();
  Vector3d offset = Vector3d::Zero();
  // Floats distinguish no positions of a smaller extent, and the unit below could not be divided by.
  constexpr double kLeastExtent = std::numeric_limits<float>::min();
  if (!(extent >= kLeastExtent && std::isfinite(extent))) return offset;
  const double unit = std::exp2(std::ceil(std::log2(extent)));
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double low = box.min()[axis], high = box.max()[axis];
    if (std::max(std::abs(low), std::abs(high)) > kMostDistance * extent)
      offset[axis] = std::round((low + high) / 2 / unit) * unit;
  }
  return offset;
}

void round_column(Column<double>&& from, double offset, std::span<float> to) {
  std::transform(from.begin(), from.end(), to.begin(),
                 [&](double value) { return to_float(value - offset); });
  Column<double>().swap(from);
}

Points round_to_floats(Positions&& positions, const Vector3d& offset) {
  Points points(positions.size());
  const PointsSpan span = points.span();
  round_column(std::move(positions.x), offset.x(), span.x);
  round_column(std::move(positions.y), offset.y(), span.y);
  round_column(std::move(positions.z), offset.z(), span.z);
  return points;
}

}  // namespace

void place(Positions positions, const Input& input, Cloud& cloud) {
  cloud.offset = Vector3d::Zero();
  if (!input.options.keep_origin) cloud.offset = choose_offset(box_of(positions));
  cloud.points = round_to_floats(std::move(positions), cloud.offset);
}

Points round_to_floats(Positions vectors) {
  return round_to_floats(std::move(vectors), Vector3d::Zero());
}

void place_viewpoint(const Vector3d& viewpoint, Cloud& cloud) {
  const Vector3d shifted = viewpoint - cloud.offset;
  cloud.viewpoint =
      Eigen::Vector3f(to_float(shifted.x()), to_float(shifted.y()), to_float(shifted.z()));
}

}  // namespace trivet::formats
