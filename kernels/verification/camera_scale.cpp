#include "kernels/verification/camera_scale.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "kernels/common/pose_math.hpp"

namespace trivet::kernels {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Errors of calibrations are below a tenth.
constexpr double kPriorInformation = 1 / (0.1 * 0.1);
// Relative errors of models and independent pixels, and of sensors that match windows: the stated
// cameras of real data sets differ from 1 by up to 3.7 %, root mean square 2.
constexpr double kModelError = 0.002, kWindowError = 0.02;
constexpr float kErrAlike = 0.3F;  // correlation above which depth is not estimated

/// Slight damping constrains motions that the surface leaves free, such as rotation about its axis.
Matrix6 pose_information(const ObjectEquations& equations) {
  Matrix6 A = equations.information.topLeftCorner<6, 6>();
  A.diagonal() += 1e-6 * A.diagonal() + Eigen::Matrix<double, 6, 1>::Constant(1e-30);
  return A;
}

/// Sum of the squared pulls of the groups, scaled up for few groups; one group gives no estimate.
template <class Group>
Eigen::Matrix2d scatter_of(std::span<const ScalePull> objects, const Eigen::Vector2d& scales,
                           Group&& group) {
  std::map<std::size_t, Eigen::Vector2d> rests;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const auto rest = rests.try_emplace(group(k), Eigen::Vector2d::Zero()).first;
    rest->second += objects[k].pull - objects[k].information * scales;
  }
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  if (rests.size() < 2) return sum;
  for (const auto& [_, rest] : rests) sum += rest * rest.transpose();
  const auto n = static_cast<double>(rests.size());
  return n / (n - 1) * sum;
}

/// Number of equally informative models with the same total information.
double count_models(std::span<const ScalePull> objects) {
  std::map<std::uint32_t, double> shares;
  double sum = 0, squares = 0;
  for (const ScalePull& object : objects) shares[object.model] += object.information(0, 0);
  for (const auto& [_, share] : shares) {
    sum += share;
    squares += share * share;
  }
  return squares > 0 ? sum * sum / squares : 0;
}

}  // namespace

ScalePull leave_pose_free(const ObjectEquations& equations, const LogScales& scales) {
  const Eigen::Matrix<double, 6, 2> shared = equations.information.topRightCorner<6, 2>();
  const Eigen::Matrix<double, 6, 2> by_pose = pose_information(equations).ldlt().solve(shared);
  const auto eliminate = [&](const ObjectEquations::Vector8& pull) -> Eigen::Vector2d {
    return pull.tail<2>() - by_pose.transpose() * pull.head<6>();
  };
  ScalePull out;
  out.information = equations.information.bottomRightCorner<2, 2>() - shared.transpose() * by_pose;
  out.pull =
      eliminate(equations.pull) + out.information * Eigen::Vector2d(scales.focal, scales.depth);
  for (const ObjectEquations::Vector8& block : equations.blocks) {
    const Eigen::Vector2d pull = eliminate(block);
    out.scatter += pull * pull.transpose();
  }
  return out;
}

Pose follow_scales(const ObjectEquations& equations, const LogScales& step,
                   const Pose& T_camera_model, const Eigen::Vector3f& model_center) {
  const Eigen::Matrix<double, 6, 1> rest =
      equations.pull.head<6>() -
      equations.information.topRightCorner<6, 2>() * Eigen::Vector2d(step.focal, step.depth);
  const Eigen::Matrix<double, 6, 1> motion = pose_information(equations).ldlt().solve(rest);
  Pose pose = small_motion(motion.head<3>().cast<float>(), motion.tail<3>().cast<float>(),
                           T_camera_model * model_center) *
              T_camera_model;
  pose.linear() = Eigen::Quaternionf(pose.linear()).normalized().toRotationMatrix();
  return pose;
}

CameraScale estimate_scales(std::span<const ScalePull> given) {
  std::vector<ScalePull> objects(given.begin(), given.end());
  float correlation = 0;
  for (const ScalePull& object : objects) correlation = std::max(correlation, object.correlation);
  const bool is_depth_determined = correlation < kErrAlike;
  if (!is_depth_determined) {
    const Eigen::Vector2d focal_only(1, 0);
    for (ScalePull& object : objects) {
      object.information = focal_only.asDiagonal() * object.information * focal_only.asDiagonal();
      object.scatter = focal_only.asDiagonal() * object.scatter * focal_only.asDiagonal();
      object.pull[1] = 0;
    }
  }

  Eigen::Matrix2d information = kPriorInformation * Eigen::Matrix2d::Identity(),
                  by_block = Eigen::Matrix2d::Zero();
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();
  for (const ScalePull& object : objects) {
    information += object.information;
    by_block += object.scatter;
    pull += object.pull;
  }
  const Eigen::Matrix2d inverse = information.inverse();
  const Eigen::Vector2d scales = inverse * pull;
  const Eigen::Matrix2d by_object = scatter_of(objects, scales, [](std::size_t k) { return k; });
  const Eigen::Matrix2d by_model =
      scatter_of(objects, scales, [&](std::size_t k) -> std::size_t { return objects[k].model; });

  CameraScale out;
  out.num_models = count_models(objects);
  const double window_error = kWindowError * static_cast<double>(correlation);
  const double systematic =
      std::hypot(kModelError, window_error) / std::sqrt(std::max(1.0, out.num_models));
  const auto factor = [&](Eigen::Index k) {
    double variance = 0;
    for (const Eigen::Matrix2d& scatter : {by_block, by_object, by_model})
      variance = std::max(variance, (inverse * scatter * inverse)(k, k));
    const double value = std::exp(scales[k]);
    return Factor{value, value * std::sqrt(variance + systematic * systematic)};
  };
  out.focal = factor(0);
  if (is_depth_determined) out.depth = factor(1);
  return out;
}

}  // namespace trivet::kernels
