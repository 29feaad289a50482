/// Pose refinement: point-to-plane ICP with projective association and robust weights.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/scans/range_image.hpp"
#include "kernels/verification/verify_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

struct RefineOptions {
  std::size_t num_samples = 400;  ///< number of samples used, the first ones of the model
  int max_iterations = 10;
  /// Largest residual with weight in the first iteration [scene unit], > 0.
  float first_gate = 0;
  float last_gate = 0;  ///< gate of the last iteration; it shrinks geometrically, > 0
  float max_normal_angle_rad = 1.0F;
  /// One per plane number, as VerifyOptions::plane_is_background: what it measures draws no pose.
  std::span<const std::uint8_t> plane_is_background{};
  /// Largest motion of the model's center, beyond which the result is discarded, > 0.
  float max_translation = 0;
  float max_rotation_rad = 0.35F;
};

struct Refined {
  Pose T_scene_model;
  int iterations = 0;
  bool moved_too_far = false;  ///< true: the pose is the initial one
};

/// Minimize sum w (n . (T p - q))^2 over the visible samples p, where q is the measured point on
/// p's viewing ray and n its normal (Chen and Medioni, 1992; association as Blais and Levine, PAMI
/// 1995; weights of Tukey). No allocation. With fewer than 20 correspondences the pose does not
/// change.
Refined refine_pose(std::span<const RangeImage> images, const ModelSamples& samples,
                    const Pose& T_scene_model, const RefineOptions& options) noexcept;

}  // namespace trivet::kernels
