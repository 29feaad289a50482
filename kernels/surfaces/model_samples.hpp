/// What a model's surface is looked at by.
#pragma once

#include <Eigen/Core>
#include <span>

#include "storage/data/model.hpp"

namespace trivet::kernels {

/// The surface samples of a model, in an order of which every prefix covers the surface evenly.
struct ModelSamples {
  PointsView points;
  NormalsView normals;
  std::span<const ViewMask> views;
  float spacing = 0;  ///< between neighboring samples
  float diameter = 0;
  Eigen::Vector3f center{0, 0, 0};
};

}  // namespace trivet::kernels
