// Point pair features from OpenCV's surface_matching: training and matching with the same steps.
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/surface_matching.hpp>
#include <opencv2/surface_matching/ppf_helpers.hpp>

#include "parts.hpp"

namespace trivet::bench {
namespace {

namespace ppf = cv::ppf_match_3d;

constexpr double kDiameter = 0.2;  // approximate diameter of the parts

double step_of(std::int64_t thousandths) { return static_cast<double>(thousandths) / 1000; }

cv::Mat as_opencv(const OrientedPoints& surface) {
  cv::Mat rows(static_cast<int>(surface.points.size()), 6, CV_32F);
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    float* const row = rows.ptr<float>(static_cast<int>(i));
    Eigen::Map<Eigen::Vector3f>{row} = surface.points[i];
    Eigen::Map<Eigen::Vector3f>{row + 3} = surface.normals[i];
  }
  return rows;
}

using Detector = std::unique_ptr<ppf::PPF3DDetector>;  // copies would free its memory twice

// OpenCV's defaults cluster by absolute distances, whatever the unit, and find almost nothing.
Detector train(const cv::Mat& surface, double step) {
  auto detector = std::make_unique<ppf::PPF3DDetector>(step, step, 30);
  detector->setSearchParams(0.05 * kDiameter, 12 * std::numbers::pi / 180, true);
  detector->trainModel(surface);
  return detector;
}

// A detector for each part; the same on every call.
const std::vector<Detector>& trained(std::int64_t thousandths) {
  static std::map<std::int64_t, std::vector<Detector>> detectors;
  const auto [entry, is_new] = detectors.try_emplace(thousandths);
  if (is_new) {
    for (const Part& part : parts()) {
      entry->second.push_back(train(as_opencv(part_surface(part)), step_of(thousandths)));
    }
  }
  return entry->second;
}

using Box = std::array<cv::Vec2f, 3>;  // low and high of x, y and z

Box box_of(const cv::Mat& points) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    double low = 0, high = 0;
    cv::minMaxLoc(points.col(axis), &low, &high);
    box[static_cast<std::size_t>(axis)] = cv::Vec2d(low, high);
  }
  return box;
}

// OpenCV's scene step is relative to the mean side of the bounding box; this value makes it equal
// to the model's step.
double scene_step(const cv::Mat& scene, double step) {
  double sides = 0;
  for (const cv::Vec2f& side : box_of(scene)) sides += double{side[1] - side[0]};
  return step * kDiameter / (sides / 3);
}

// OpenCV's rotations are scaled, since it averages the quaternions of a cluster without
// normalizing: this removes the scale.
std::optional<Pose> match(ppf::PPF3DDetector& detector, const cv::Mat& scene, double step) {
  std::vector<ppf::Pose3DPtr> found;
  detector.match(scene, found, 1.0 / 5, scene_step(scene, step));
  if (found.empty()) return std::nullopt;
  Eigen::Matrix4d T;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) T(row, column) = found[0]->pose(row, column);
  }
  const double scale = std::cbrt(T.topLeftCorner<3, 3>().determinant());
  T.topLeftCorner<3, 3>() /= scale;
  return Pose(T.cast<float>());
}

void train_opencv(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat surface = as_opencv(part_surface(parts()[0]));
  for (auto _ : state) benchmark::DoNotOptimize(train(surface, step_of(state.range(0))));
  auto [x, y, z] = box_of(surface);
  const double n =
      ppf::samplePCByQuantization(surface, x, y, z, static_cast<float>(step_of(state.range(0))), 0)
          .rows;
  state.counters["points"] = n;
  state.counters["pairs"] = n * (n - 1);
}
BENCHMARK(train_opencv)->Name("train/opencv")->Arg(100)->Arg(70)->Apply(measure_process_time);

void recognize_opencv(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat scene = as_opencv(scan_without_wall());
  const std::vector<Detector>& detectors = trained(state.range(0));
  std::vector<std::optional<Pose>> poses(detectors.size());
  for (auto _ : state) {
    for (std::size_t k = 0; k < detectors.size(); ++k)
      poses[k] = match(*detectors[k], scene, step_of(state.range(0)));
  }
  report_poses(state, poses);
}
BENCHMARK(recognize_opencv)
    ->Name("recognize/opencv")
    ->Arg(100)
    ->Arg(70)
    ->Apply(measure_process_time);

}  // namespace
}  // namespace trivet::bench
