#include "engine/evaluation/pose_error.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

namespace trivet::engine {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMaxTranslation = 0.1;  // [diameters]
constexpr double kMaxRotationDeg = 12;
/// A mean over more vertices takes longer without being more informative.
constexpr std::size_t kMaxAddVertices = 3000;

double degrees(double radians) noexcept { return radians * 180 / std::numbers::pi; }

}  // namespace

bool PoseError::right() const noexcept {
  return translation < kMaxTranslation && rotation_deg < kMaxRotationDeg;
}

double PoseError::rank() const noexcept {
  return translation / kMaxTranslation + rotation_deg / kMaxRotationDeg;
}

PoseJudge::PoseJudge(const EvaluationMesh& mesh) : mesh_(mesh) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    box.extend(mesh.vertices[i].cast<double>());
  center_ = box.center();
}

PoseError PoseJudge::error(const Pose& estimate, const Pose& truth) const {
  PoseError best = error_of_one(estimate, truth);
  for (const Pose& S : mesh_.symmetry.poses) {
    const PoseError error = error_of_one(estimate, truth * S);
    if (error.rank() < best.rank()) best = error;
  }
  return best;
}

double PoseJudge::add(const Pose& estimate, const Pose& truth) {
  // In the truth's model frame, where the vertices are fixed.
  const Eigen::Isometry3d motion = (truth.inverse() * estimate).cast<double>();
  const std::size_t n = mesh_.vertices.size();
  const std::size_t stride = (n + kMaxAddVertices - 1) / kMaxAddVertices;
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; i += stride, ++count) {
    const Vector3d vertex = mesh_.vertices[i].cast<double>(), moved = motion * vertex;
    sum += mesh_.symmetry.trivial() ? (moved - vertex).norm() : distance_to_vertices(moved);
  }
  return sum / static_cast<double>(count) / mesh_.diameter;
}

PoseError PoseJudge::error_of_one(const Pose& estimate, const Pose& truth) const {
  const Matrix3d a = estimate.linear().cast<double>(), b = truth.linear().cast<double>();
  const Vector3d shift = a * center_ + estimate.translation().cast<double>() - b * center_ -
                         truth.translation().cast<double>();
  double angle = 0;
  if (mesh_.symmetry.axis) {
    const Vector3d axis = mesh_.symmetry.axis->direction.cast<double>();
    angle = std::atan2((a * axis).cross(b * axis).norm(), (a * axis).dot(b * axis));
  } else {
    angle = Eigen::AngleAxisd(Matrix3d(a.transpose() * b)).angle();
  }
  return {shift.norm() / mesh_.diameter, degrees(angle)};
}

double PoseJudge::distance_to_vertices(const Vector3d& point) {
  if (!grid_) {
    const double spacing = mesh_.diameter / std::sqrt(static_cast<double>(mesh_.vertices.size()));
    grid_.emplace(mesh_.vertices, static_cast<float>(2 * spacing));
  }
  const auto nearest = grid_->nearest(point.cast<float>(), std::numeric_limits<float>::infinity());
  return nearest ? std::sqrt(static_cast<double>(nearest->squared_distance)) : mesh_.diameter;
}

}  // namespace trivet::engine
