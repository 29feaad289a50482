// Meshes from PCL, as packaged.
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>
#include <pcl/surface/organized_fast_mesh.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "meshing/mesh_input.hpp"
#include "rows.hpp"

namespace trivet::bench {
namespace {

Triangles as_triangles(const std::vector<pcl::Vertices>& polygons) {
  Triangles triangles;
  for (const pcl::Vertices& polygon : polygons) {
    triangles.push_back(static_cast<std::uint32_t>(polygon.vertices[0]),
                        static_cast<std::uint32_t>(polygon.vertices[1]),
                        static_cast<std::uint32_t>(polygon.vertices[2]));
  }
  return triangles;
}

// Angles and counts are those of PCL's tutorial. The radius equals Trivet's; a mu of 2.5, relative
// to the distance of the nearest point, leaves holes among random points, one of 30 leaves only the
// radius as limit.
void greedy(benchmark::State& state, double mu) {
  const OrientedPoints& sphere = noisy_sphere(state.range(0));
  pcl::PointCloud<pcl::PointNormal>::Ptr cloud(new pcl::PointCloud<pcl::PointNormal>);
  for (std::size_t i = 0; i < sphere.points.size(); ++i) {
    pcl::PointNormal point;
    point.getVector3fMap() = sphere.points[i];
    point.getNormalVector3fMap() = sphere.normals[i];
    cloud->push_back(point);
  }
  const double spacing =
      std::sqrt(4 * std::numbers::pi / static_cast<double>(sphere.points.size()));
  std::vector<pcl::Vertices> polygons;
  for (auto _ : state) {
    pcl::GreedyProjectionTriangulation<pcl::PointNormal> mesher;
    mesher.setSearchRadius(3.4 * spacing);
    mesher.setMu(mu);
    mesher.setMaximumNearestNeighbors(100);
    mesher.setMaximumSurfaceAngle(std::numbers::pi / 4);
    mesher.setMinimumAngle(std::numbers::pi / 18);
    mesher.setMaximumAngle(2 * std::numbers::pi / 3);
    mesher.setNormalConsistency(true);
    mesher.setInputCloud(cloud);
    mesher.setSearchMethod(
        pcl::search::KdTree<pcl::PointNormal>::Ptr(new pcl::search::KdTree<pcl::PointNormal>));
    mesher.reconstruct(polygons);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  report_sphere(state, sphere, as_triangles(polygons));
}

const bool kGreedy = [] {
  for (const auto& [name, mu] :
       {std::pair{"mesh_greedy/pcl_mu_2.5", 2.5}, {"mesh_greedy/pcl_mu_30", 30.0}}) {
    auto* row = benchmark::RegisterBenchmark(
        name, [mu = mu](benchmark::State& state) { greedy(state, mu); });
    row->Unit(benchmark::kMillisecond);
    for (const std::int64_t n : kMeshPoints) row->Arg(n);
  }
  return true;
}();

const bool kGrid = [] {
  auto* row = add_row("mesh_grid/pcl", [](benchmark::State& state, const Scan& scan) {
    pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(
        new pcl::PointCloud<pcl::PointXYZ>(scan.grid.width, scan.grid.height));
    for (std::size_t i = 0; i < scan.points.size(); ++i)
      cloud->points[i].getVector3fMap() = scan.points[i];
    std::vector<pcl::Vertices> polygons;
    for (auto _ : state) {
      pcl::OrganizedFastMesh<pcl::PointXYZ> mesher;
      mesher.setTriangulationType(pcl::OrganizedFastMesh<pcl::PointXYZ>::TRIANGLE_ADAPTIVE_CUT);
      mesher.setInputCloud(cloud);
      mesher.reconstruct(polygons);
    }
    report_scan(state, scan, as_triangles(polygons));
  });
  for (const std::int64_t width : kMeshWidths) row->Arg(width);
  return true;
}();

}  // namespace
}  // namespace trivet::bench
