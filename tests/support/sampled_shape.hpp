/// Samples of a mesh's surface as training makes them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "kernels/common/ray_scene.hpp"
#include "kernels/surfaces/sample_mesh.hpp"
#include "kernels/surfaces/visibility.hpp"
#include "kernels/verification/verify_pose.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::test {

/// Area-uniform samples that are visible from outside, with outward normals, in random order.
struct SampledShape {
  Points points;
  Normals normals;
  std::vector<ViewMask> views;
  float diameter = 0;  ///< diameter of the box around the vertices
  float spacing = 0;

  kernels::ModelSamples view() const {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) sum += points[i];
    return {points, normals, views, spacing, diameter, sum / static_cast<float>(points.size())};
  }
};

inline SampledShape sample_shape(PointsView vertices, const Triangles& triangles,
                                 std::uint64_t seed = 1, std::size_t n = 2048) {
  std::vector<double> sums(triangles.size());
  kernels::sum_areas(vertices, triangles, sums);
  Points points(n);
  Normals normals(n);
  kernels::sample_mesh({vertices, triangles, sums}, seed, 0, n, {points, normals});
  SampledShape surface;
  surface.spacing = static_cast<float>(std::sqrt(sums.back() / static_cast<double>(n)));
  Eigen::Array3f low = vertices[0], high = low;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    low = low.min(vertices[i].array());
    high = high.max(vertices[i].array());
  }
  surface.diameter = (high - low).matrix().norm();
  const auto scene = kernels::RayScene::from_mesh(vertices, triangles);
  std::vector<ViewMask> views(n);
  kernels::orient_outward(*scene, points, normals, 1e-4F * surface.diameter, views);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  for (const std::size_t i : order) {
    if (views[i] == ViewMask{}) continue;
    surface.points.push_back(points[i]);
    surface.normals.push_back(normals[i]);
    surface.views.push_back(views[i]);
  }
  return surface;
}

}  // namespace trivet::test
