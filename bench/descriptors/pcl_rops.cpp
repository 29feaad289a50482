// RoPS from PCL, as packaged.
#include <pcl/features/rops_estimation.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>

#include "descriptors/descriptors.hpp"
#include "engine/common/parallel.hpp"

namespace trivet::bench {
namespace {

using PclCloud = pcl::PointCloud<pcl::PointXYZ>;
using Rops = pcl::Histogram<kRopsSize>;

PclCloud::Ptr as_pcl(PointsView points) {
  PclCloud::Ptr cloud(new PclCloud);
  for (std::size_t i = 0; i < points.size(); ++i)
    cloud->emplace_back(points.x[i], points.y[i], points.z[i]);
  return cloud;
}

}  // namespace

void describe_rops(const KeypointSurface& surface, std::span<float> features) {
  const PclCloud::Ptr vertices = as_pcl(surface.mesh.vertices);
  const Triangles& triangles = surface.mesh.triangles;
  std::vector<pcl::Vertices> faces(triangles.size());
  for (std::size_t t = 0; t < faces.size(); ++t)
    for (const std::uint32_t corner : {triangles.a[t], triangles.b[t], triangles.c[t]})
      faces[t].vertices.push_back(static_cast<pcl::index_t>(corner));

  // Each estimation uses one thread and a separate list of all triangles.
  constexpr std::size_t kKeypointsAtOnce = 250;
  engine::for_chunks(
      surface.keypoints.size(), kKeypointsAtOnce, [&](std::size_t first, std::size_t count) {
        const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
        pcl::ROPSEstimation<pcl::PointXYZ, Rops> estimation;
        estimation.setInputCloud(as_pcl(surface.keypoints.view().slice(first, count)));
        estimation.setSearchSurface(vertices);
        estimation.setSearchMethod(tree);
        estimation.setTriangles(faces);
        estimation.setRadiusSearch(static_cast<double>(surface.radius));
        estimation.setSupportRadius(surface.radius);
        estimation.setNumberOfRotations(3);
        estimation.setNumberOfPartitionBins(5);
        pcl::PointCloud<Rops> described;
        estimation.compute(described);
        for (std::size_t k = 0; k < described.size(); ++k) {
          const auto& values = described[k].histogram;
          if (!std::ranges::all_of(values, [](float v) { return std::isfinite(v); })) continue;
          std::ranges::copy(
              values, features.begin() + static_cast<std::ptrdiff_t>((first + k) * kRopsSize));
        }
      });
}

}  // namespace trivet::bench
