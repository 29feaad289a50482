// Normals and voxel grids by PCL as packaged, with its defaults where it has any.
#include <pcl/features/integral_image_normal.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/approximate_voxel_grid.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "rows.hpp"

namespace trivet::bench {
namespace {

using PclCloud = pcl::PointCloud<pcl::PointXYZ>;
using PclNormals = pcl::PointCloud<pcl::Normal>;

constexpr float kCell = 0.01F;

PclCloud::Ptr as_pcl(const Scan& scan) {
  PclCloud::Ptr cloud(new PclCloud(scan.grid.width, scan.grid.height));
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    cloud->points[i].getVector3fMap() = scan.points[i];
  }
  return cloud;
}

double angle_rmse_deg(const Scan& scan, const PclNormals& found) {
  Normals normals;
  for (const pcl::Normal& n : found) normals.push_back(n.getNormalVector3fMap());
  return bench::angle_rmse_deg(scan, normals);
}

const bool kVoxelGrid = add_rows("voxel_grid/pcl", [](benchmark::State& state, const Scan& scan) {
  const PclCloud::Ptr cloud = as_pcl(scan);
  PclCloud out;
  for (auto _ : state) {
    pcl::VoxelGrid<pcl::PointXYZ> filter;
    filter.setInputCloud(cloud);
    filter.setLeafSize(kCell, kCell, kCell);
    filter.filter(out);
  }
  state.counters["voxels"] = static_cast<double>(out.size());
});

const bool kApproximate =
    add_rows("approximate_voxel_grid/pcl", [](benchmark::State& state, const Scan& scan) {
      const PclCloud::Ptr cloud = as_pcl(scan);
      PclCloud out;
      for (auto _ : state) {
        pcl::ApproximateVoxelGrid<pcl::PointXYZ> filter;
        filter.setInputCloud(cloud);
        filter.setLeafSize(kCell, kCell, kCell);
        filter.filter(out);
      }
      state.counters["voxels"] = static_cast<double>(out.size());
    });

const bool kKdTree =
    add_rows("radius_search/pcl_kd_tree", [](benchmark::State& state, const Scan& scan) {
      const PclCloud::Ptr cloud = as_pcl(scan);
      double num_neighbors = 0;
      for (auto _ : state) {
        pcl::KdTreeFLANN<pcl::PointXYZ> tree;
        tree.setSortedResults(false);
        tree.setInputCloud(cloud);
        pcl::Indices indices;
        std::vector<float> distances;
        num_neighbors = 0;
        for (const pcl::PointXYZ& point : *cloud) {
          num_neighbors += tree.radiusSearch(point, search_radius(scan), indices, distances);
        }
      }
      state.counters["neighbors"] = num_neighbors / static_cast<double>(cloud->size());
    });

// Neighbors from a k-d tree, as for any cloud, or from the pixels, which PCL prefers where
// possible.
void radius_normals(benchmark::State& state, const Scan& scan, bool organized) {
  const PclCloud::Ptr cloud = as_pcl(scan);
  if (!organized) {
    cloud->width = static_cast<std::uint32_t>(cloud->size());
    cloud->height = 1;
  }
  PclNormals normals;
  for (auto _ : state) {
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(cloud);
    estimation.setRadiusSearch(search_radius(scan));
    estimation.compute(normals);
  }
  state.counters["angle_rmse_deg"] = angle_rmse_deg(scan, normals);
}

const bool kRadiusNormals =
    add_rows("normals/pcl_radius",
             [](benchmark::State& state, const Scan& scan) { radius_normals(state, scan, false); });

const bool kOrganizedNormals =
    add_rows("normals/pcl_radius_in_pixels",
             [](benchmark::State& state, const Scan& scan) { radius_normals(state, scan, true); });

const bool kIntegralImageNormals =
    add_rows("normals/pcl_integral_image", [](benchmark::State& state, const Scan& scan) {
      const PclCloud::Ptr cloud = as_pcl(scan);
      PclNormals normals;
      for (auto _ : state) {
        pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
        estimation.setNormalEstimationMethod(estimation.COVARIANCE_MATRIX);
        estimation.setNormalSmoothingSize(7);
        estimation.setMaxDepthChangeFactor(0.02F);
        estimation.setInputCloud(cloud);
        estimation.compute(normals);
      }
      state.counters["angle_rmse_deg"] = angle_rmse_deg(scan, normals);
    });

}  // namespace
}  // namespace trivet::bench
