// Point pair features from PCL: training and matching with the same steps, and its point-to-plane
// ICP.
#include <pcl/console/print.h>
#include <pcl/features/ppf.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ppf_registration.h>

#include <map>
#include <numbers>

#include "parts.hpp"

namespace trivet::bench {
namespace {

using PclCloud = pcl::PointCloud<pcl::PointNormal>;

constexpr float kDiameter = 0.2F;  // approximate diameter of the parts
constexpr float kRadiansPerDegree = std::numbers::pi_v<float> / 180;

float step_of(std::int64_t thousandths) {
  return static_cast<float>(thousandths) / 1000 * kDiameter;
}

PclCloud::Ptr as_pcl(const OrientedPoints& surface) {
  PclCloud::Ptr cloud(new PclCloud);
  cloud->resize(surface.points.size());
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    (*cloud)[i].getVector3fMap() = surface.points[i];
    (*cloud)[i].getNormalVector3fMap() = surface.normals[i];
  }
  return cloud;
}

// The filter averages normals: they are normalized again, and dropped where they cancel out.
PclCloud::Ptr thinned(const PclCloud::Ptr& cloud, float step) {
  PclCloud averages;
  pcl::VoxelGrid<pcl::PointNormal> filter;
  filter.setInputCloud(cloud);
  filter.setLeafSize(step, step, step);
  filter.filter(averages);
  PclCloud::Ptr kept(new PclCloud);
  for (pcl::PointNormal point : averages) {
    const float length = point.getNormalVector3fMap().norm();
    if (length < 0.01F) continue;
    point.getNormalVector3fMap() /= length;
    kept->push_back(point);
  }
  return kept;
}

struct PclModel {
  PclCloud::Ptr points;
  pcl::PPFHashMapSearch::Ptr search;
};

PclModel train(const PclCloud::Ptr& surface, float step) {
  PclModel model;
  model.points = thinned(surface, step);
  const pcl::PointCloud<pcl::PPFSignature>::Ptr features(new pcl::PointCloud<pcl::PPFSignature>);
  pcl::PPFEstimation<pcl::PointNormal, pcl::PointNormal, pcl::PPFSignature> estimation;
  estimation.setInputCloud(model.points);
  estimation.setInputNormals(model.points);
  estimation.compute(*features);
  model.search.reset(new pcl::PPFHashMapSearch(12 * kRadiansPerDegree, step));
  model.search->setInputFeatureCloud(features);
  return model;
}

// A model for each part; the same on every call.
const std::vector<PclModel>& trained(std::int64_t thousandths) {
  static std::map<std::int64_t, std::vector<PclModel>> models;
  const auto [entry, is_new] = models.try_emplace(thousandths);
  if (is_new) {
    for (const Part& part : parts())
      entry->second.push_back(train(as_pcl(part_surface(part)), step_of(thousandths)));
  }
  return entry->second;
}

Pose match(const PclModel& model, const PclCloud::Ptr& scene, float step) {
  pcl::PPFRegistration<pcl::PointNormal, pcl::PointNormal> registration;
  registration.setSceneReferencePointSamplingRate(5);  // a fifth of the points, as in Trivet
  registration.setPositionClusteringThreshold(0.1F * kDiameter);
  registration.setRotationClusteringThreshold(30 * kRadiansPerDegree);
  registration.setSearchMethod(model.search);
  registration.setInputSource(model.points);
  registration.setInputTarget(thinned(scene, step));
  PclCloud unused;
  registration.align(unused);
  return Pose(registration.getFinalTransformation());
}

void train_pcl(benchmark::State& state) {
  const PclCloud::Ptr surface = as_pcl(part_surface(parts()[0]));
  PclModel model;
  for (auto _ : state) model = train(surface, step_of(state.range(0)));
  const auto n = static_cast<double>(model.points->size());
  state.counters["points"] = n;
  state.counters["pairs"] = n * (n - 1);
}
BENCHMARK(train_pcl)->Name("train/pcl")->Arg(100)->Arg(70)->Apply(measure_process_time);

void recognize_pcl(benchmark::State& state) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  const PclCloud::Ptr scene = as_pcl(scan_without_wall());
  const std::vector<PclModel>& models = trained(state.range(0));
  std::vector<std::optional<Pose>> poses(models.size());
  for (auto _ : state) {
    for (std::size_t k = 0; k < models.size(); ++k)
      poses[k] = match(models[k], scene, step_of(state.range(0)));
  }
  report_poses(state, poses);
}
BENCHMARK(recognize_pcl)->Name("recognize/pcl")->Arg(100)->Arg(70)->Apply(measure_process_time);

void icp_pcl(benchmark::State& state) {
  constexpr float kStep = 0.02F * kDiameter;
  const PclCloud::Ptr model = thinned(as_pcl(part_surface(parts()[0])), kStep);
  const PclCloud::Ptr scene = thinned(as_pcl(scan_without_wall()), kStep);
  std::vector<Pose> refined(rough_poses().size());
  pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> icp;
  icp.setMaximumIterations(30);
  icp.setMaxCorrespondenceDistance(0.06 * double{kDiameter});
  icp.setInputSource(model);
  icp.setInputTarget(scene);
  PclCloud unused;
  for (auto _ : state) {
    for (std::size_t k = 0; k < refined.size(); ++k) {
      icp.align(unused, rough_poses()[k].matrix());
      refined[k] = Pose(icp.getFinalTransformation());
    }
  }
  state.counters["points"] = static_cast<double>(model->size());
  report_refined(state, refined);
}
BENCHMARK(icp_pcl)->Name("icp/pcl")->Apply(measure_process_time);

}  // namespace
}  // namespace trivet::bench
