/// One model in one scene: refine its poses and test them.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/poses/pose_table.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "kernels/common/ray_scene.hpp"
#include "kernels/verification/compare_poses.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "kernels/verification/pose_score.hpp"
#include "kernels/verification/refine_pose.hpp"

namespace trivet::engine {

struct PoseTestOptions {
  VerifyStageOptions verify{};
  PoseLimits limits{};
  bool refinement = true;  ///< else poses stay where they are
  bool background = true;  ///< planes larger than the model support no pose of it
  bool operator==(const PoseTestOptions&) const = default;
};

/// A model's samples as kernels take them.
kernels::ModelSamples samples_of(const Model& model) noexcept;

/// All its arguments must outlive it. Its methods may be called from many threads.
class PoseTester {
 public:
  PoseTester(const Model& model, const PreparedScene& scene, const PoseTestOptions& options);
  PoseTester(const PoseTester&) = delete;
  PoseTester& operator=(const PoseTester&) = delete;

  const Model& model() const noexcept { return model_; }
  const PreparedScene& scene() const noexcept { return scene_; }
  const kernels::ModelSamples& samples() const noexcept { return samples_; }
  /// How a refined pose is verified: with what the sensor errs by at its range.
  kernels::VerifyOptions strict(const Pose& pose) const;
  /// How a pose is verified that votes propose: with the tolerance of an unrefined one.
  kernels::VerifyOptions loose(const Pose& pose) const;

  /// What the sensor errs by across a surface at this pose's range [library unit].
  float error_at(const Pose& pose) const { return scene_.sensor.error_at(range_of(pose)); }
  /// The same and what of it neighbors share, to compare poses by.
  kernels::MeasurementErrors errors_of(const Pose& pose) const;
  /// By which this pose's outline may be seen beside its place [pixel].
  int edge_pixels(const Pose& pose) const;

  bool allowed(const Pose& pose) const {
    return options_.limits.allow(pose, model_.center, 1 / scene_.scale);
  }

  /// Refined from where the votes left it, with some of the samples.
  Pose refined(const Pose& pose) const;
  /// Refined once more with all samples.
  Pose polished(const Pose& pose) const;

  /// Test by rays.
  TestedPose examine(const kernels::RayScene& surface, const kernels::ScoreModel& score,
                     const Pose& pose, kernels::ExamineScratch& scratch) const;
  /// What the rays of that test say one by one.
  std::vector<kernels::JudgedRay> judged_rays(const kernels::RayScene& surface,
                                              const Pose& pose) const;

 private:
  kernels::ExamineOptions examine_options(const Pose& pose) const;
  const std::optional<Symmetry::Axis>& free_axis() const;
  Pose refined(const Pose& pose, const kernels::RefineOptions& options) const;
  float range_of(const Pose& pose) const;

  const Model& model_;
  const PreparedScene& scene_;
  const PoseTestOptions& options_;
  kernels::ModelSamples samples_;
  std::vector<std::uint8_t> background_;
};

}  // namespace trivet::engine
