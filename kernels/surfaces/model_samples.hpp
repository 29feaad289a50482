/// Surface samples of a model.
#pragma once

#include <Eigen/Core>
#include <span>

#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Surface samples of a model, ordered so that every prefix covers the surface evenly.
struct ModelSamples {
  PointsView points;
  NormalsView normals;
  std::span<const ViewMask> views;
  float spacing = 0;  ///< distance between neighboring samples
  float diameter = 0;
  Eigen::Vector3f center{0, 0, 0};
};

}  // namespace trivet::kernels
