/// Conversion between units of length.
#pragma once

#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

/// Multiply each coordinate by `scale`, rounding to float once.
inline Points scaled_points(PointsView points, double scale) {
  Points out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    out.set(i, (points[i].cast<double>() * scale).cast<float>());
  }
  return out;
}

inline Symmetry scaled(Symmetry symmetry, double scale) {
  const auto f = static_cast<float>(scale);
  for (Pose& pose : symmetry.poses) pose.translation() *= f;
  if (symmetry.axis) symmetry.axis->point *= f;
  return symmetry;
}

}  // namespace trivet::engine
