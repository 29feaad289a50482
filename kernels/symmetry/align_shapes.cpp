#include "kernels/symmetry/align_shapes.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "kernels/common/pose_math.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kSurfaceSamples = 1000;
constexpr std::size_t kAlignQueries = 128;  // samples of the other shape
constexpr float kLike = 0.09F;  // largest difference of deviations along axes that may correspond
                                // [diameters]
constexpr float kEven = 0.12F;  // largest relative difference of deviations across an even axis
constexpr int kStepsAQuarter = 6;                        // rotation steps about such an axis
constexpr float kOtherRotation = 0.4F;                   // [rad]
constexpr float kNearlyAsNear = 1.3F, kAsNear = 0.015F;  // limits for further rotations: factor;
                                                         // [diameters]
constexpr std::size_t kMostRotations = 4;                // those of a box

/// The rotations that map coordinate axes onto coordinate axes.
const std::vector<Eigen::Matrix3f>& turns_of_a_cube() {
  static const std::vector<Eigen::Matrix3f> turns = [] {
    std::vector<Eigen::Matrix3f> all;
    std::array<int, 3> axis{0, 1, 2};
    do {
      for (unsigned signs = 0; signs < 8; ++signs) {
        Eigen::Matrix3f turn = Eigen::Matrix3f::Zero();
        for (int k = 0; k < 3; ++k)
          turn(axis[static_cast<std::size_t>(k)], k) = (signs >> k & 1U) != 0 ? -1.0F : 1.0F;
        if (turn.determinant() > 0) all.push_back(turn);
      }
    } while (std::next_permutation(axis.begin(), axis.end()));
    return all;
  }();
  return turns;
}

}  // namespace

ShapeFrame shape_frame(PointsView samples) {
  const auto n = static_cast<double>(samples.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) sum += samples[i].cast<double>();
  const Eigen::Vector3d center = sum / n;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d d = samples[i].cast<double>() - center;
    moments += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments / n);  // ascending
  ShapeFrame frame{center.cast<float>(), solver.eigenvectors().cast<float>(),
                   solver.eigenvalues().cwiseMax(0).cwiseSqrt().cast<float>()};
  if (frame.axes.determinant() < 0) frame.axes.col(0) *= -1;
  return frame;
}

ShapeAligner::ShapeAligner(PointsView points, NormalsView normals, const ShapeFrame& frame,
                           float diameter)
    : frame_(frame),
      diameter_(diameter),
      surface_(points.slice(0, std::min(points.size(), kSurfaceSamples)),
               normals.slice(0, std::min(points.size(), kSurfaceSamples)), diameter),
      screen_(surface_) {}

std::vector<Eigen::Matrix3f> ShapeAligner::likely_rotations(const ShapeFrame& other) const {
  std::vector<Eigen::Matrix3f> rotations;
  for (const Eigen::Matrix3f& turn : turns_of_a_cube()) {
    const Eigen::Vector3f deviations = turn.cwiseAbs() * other.deviations;
    if ((deviations - frame_.deviations).norm() > kLike * diameter_) continue;
    rotations.push_back(turn);
    for (int axis = 0; axis < 3; ++axis) {
      const float a = frame_.deviations[(axis + 1) % 3], b = frame_.deviations[(axis + 2) % 3];
      if (std::abs(a - b) > kEven * std::max(a, b)) continue;
      for (int step = 1; step < kStepsAQuarter; ++step) {
        const float angle = static_cast<float>(step) * std::numbers::pi_v<float> / 2 /
                            static_cast<float>(kStepsAQuarter);
        rotations.push_back(Eigen::AngleAxisf(angle, Eigen::Vector3f::Unit(axis)) * turn);
      }
    }
  }
  return rotations;
}

std::vector<ShapeAligner::Alignment> ShapeAligner::align(PointsView points,
                                                         const ShapeFrame& frame) const {
  // In the other shape's principal frame, in diameters.
  const std::size_t n = std::min(points.size(), kAlignQueries);
  Points queries;
  for (std::size_t i = 0; i < n; ++i)
    queries.push_back(frame.axes.transpose() * (points[i] - frame.center) / diameter_);
  Pose motion = Pose::Identity();
  motion.translation() = (frame_.center - surface_.to_model(Eigen::Vector3f::Zero())) / diameter_;
  std::vector<std::pair<float, Eigen::Matrix3f>> near;
  for (const Eigen::Matrix3f& rotation : likely_rotations(frame)) {
    motion.linear() = frame_.axes * rotation;
    const float distance = screen_.score(queries, motion, kMaxDistance);
    if (distance <= kMaxDistance) near.emplace_back(distance, rotation);
  }
  std::ranges::stable_sort(near, {}, &std::pair<float, Eigen::Matrix3f>::first);

  std::vector<Alignment> found;
  for (const auto& [distance, rotation] : near) {
    if (found.size() == kMostRotations || distance > kNearlyAsNear * near[0].first + kAsNear) break;
    Pose pose = Pose::Identity();
    pose.linear() = frame_.axes * rotation * frame.axes.transpose();
    pose.translation() = frame_.center - pose.linear() * frame.center;
    const bool known = std::ranges::any_of(found, [&](const Alignment& other) {
      return rotation_angle(other.T_this_other.linear(), pose.linear()) < kOtherRotation;
    });
    if (!known) found.push_back({pose, distance});
  }
  return found;
}

}  // namespace trivet::kernels
