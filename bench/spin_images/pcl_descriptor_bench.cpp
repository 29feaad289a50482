// The spin image from PCL, as packaged, on the same points and normals as Trivet's.
#include <pcl/features/spin_image.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include "spin_images/relief.hpp"

namespace trivet::bench {
namespace {

constexpr std::size_t kSize = 153;  // PCL's default: 8 bins from the axis, 17 along it

Column<float> describe(const KeypointSurface& surface) {
  const auto as_pcl = [](PointsView points) {
    pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
    for (std::size_t i = 0; i < points.size(); ++i)
      cloud->emplace_back(points.x[i], points.y[i], points.z[i]);
    return cloud;
  };
  const pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
  for (std::size_t k = 0; k < surface.keypoint_normals.size(); ++k) {
    const Eigen::Vector3f n = surface.keypoint_normals[k];
    normals->emplace_back(n.x(), n.y(), n.z());
  }
  pcl::SpinImageEstimation<pcl::PointXYZ, pcl::Normal, pcl::Histogram<kSize>> estimation;
  estimation.setInputCloud(as_pcl(surface.keypoints));
  estimation.setInputNormals(normals);
  estimation.setSearchSurface(as_pcl(surface.points));
  estimation.setSearchMethod(
      pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  estimation.setRadiusSearch(static_cast<double>(surface.radius));
  pcl::PointCloud<pcl::Histogram<kSize>> described;
  estimation.compute(described);
  Column<float> features;
  for (const auto& image : described)
    features.insert(features.end(), std::begin(image.histogram), std::end(image.histogram));
  return features;
}

void describe_spin(benchmark::State& state) {
  Column<float> features;
  for (auto _ : state) features = describe(relief());
  report_nearest_right(state, features, describe(noisy_relief()));
  state.counters["numbers"] = kSize;
  state.SetItemsProcessed(state.iterations() *
                          static_cast<std::int64_t>(relief().keypoints.size()));
}
BENCHMARK(describe_spin)->Name("describe/pcl_spin")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace trivet::bench
