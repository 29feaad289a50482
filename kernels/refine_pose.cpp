#include "kernels/refine_pose.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "kernels/pose_math.hpp"
#include "kernels/visibility.hpp"

namespace trivet::kernels {

Refined refine_pose(std::span<const RangeImage> images, const ModelSamples& samples,
                    const Pose& start, const RefineOptions& options) noexcept {
  Refined refined{start, 0, false};
  Pose& pose = refined.T_scene_model;
  const float shrink = std::pow(options.last_gate / options.first_gate,
                                1.0F / static_cast<float>(std::max(1, options.max_iterations - 1)));
  const float min_cosine = std::cos(options.max_normal_angle_rad);
  const std::size_t n = std::min(options.num_samples, samples.points.size());
  float gate = options.first_gate;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration, gate *= shrink) {
    const Eigen::Vector3f pivot =
        pose * samples.centre;  // turning about the object keeps the system well conditioned
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
    std::uint32_t associated = 0;
    for (const RangeImage& image : images) {
      const ImageGeometry& geometry = image.geometry;
      const Pose T_camera_model = geometry.T_camera_scene * pose;
      const Eigen::Matrix3f R_scene_camera = geometry.T_camera_scene.linear().transpose();
      const Eigen::Vector3f camera_in_model = T_camera_model.inverse().translation();
      const std::size_t view = nearest_view((camera_in_model - samples.centre).normalized());
      for (std::size_t i = 0; i < n; ++i) {
        if ((samples.views[i][view / 64] >> (view % 64) & 1) == 0) continue;
        const Eigen::Vector3f p = T_camera_model * samples.points[i];
        const std::int64_t pixel = geometry.pixel_of(p);
        if (pixel < 0) continue;
        const auto at = static_cast<std::size_t>(pixel);
        const float d = image.depth[at];
        const Eigen::Vector3f normal = image.normals[at];
        if (!(d > 0) || !(normal.dot(T_camera_model.linear() * samples.normals[i]) > min_cosine))
          continue;
        const Eigen::Vector3f q = geometry.back_project(at, d);
        const float residual = normal.dot(p - q);
        if (std::abs(residual) > gate || (p - q).squaredNorm() > 9 * gate * gate) continue;

        const float share = residual / gate;
        const float tukey = 1 - share * share;
        const double weight = static_cast<double>(tukey) * static_cast<double>(tukey);
        const Eigen::Vector3f n_scene = R_scene_camera * normal;
        const Eigen::Vector3f arm = pose * samples.points[i] - pivot;
        Eigen::Matrix<double, 6, 1> J;
        J << arm.cross(n_scene).cast<double>(), n_scene.cast<double>();
        A.noalias() += weight * J * J.transpose();
        b.noalias() -= weight * static_cast<double>(residual) * J;
        ++associated;
      }
    }
    if (associated < 20) break;
    // A little damping holds directions that the visible surface does not fix, as a plane's slide.
    A.topLeftCorner<3, 3>().diagonal().array() +=
        1e-3 * A.topLeftCorner<3, 3>().trace() / 3 + 1e-30;
    A.bottomRightCorner<3, 3>().diagonal().array() +=
        1e-3 * A.bottomRightCorner<3, 3>().trace() / 3 + 1e-30;
    const Eigen::Matrix<double, 6, 1> step = A.ldlt().solve(b);
    if (!step.allFinite()) break;
    pose = small_motion(step.head<3>().cast<float>(), step.tail<3>().cast<float>(), pivot) * pose;
    pose.linear() = Eigen::Quaternionf(pose.linear()).normalized().toRotationMatrix();
    refined.iterations = iteration + 1;
  }
  const float translation = (pose * samples.centre - start * samples.centre).norm();
  const float rotation = rotation_angle(pose.linear(), start.linear());
  if (!(translation <= options.max_translation) || !(rotation <= options.max_rotation_rad)) {
    refined.T_scene_model = start;
    refined.moved_too_far = true;
  }
  return refined;
}

}  // namespace trivet::kernels
