/// Refinement and tests of one model's poses in one scene.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/poses/pose_table.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "kernels/common/ray_scene.hpp"
#include "kernels/scoring/pose_score.hpp"
#include "kernels/verification/compare_poses.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "kernels/verification/refine_pose.hpp"
#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

struct PoseTestOptions {
  VerifyStageOptions verify{};
  PoseLimits limits{};
  bool refinement = true;  ///< if false, poses are not refined
  bool background = true;  ///< if true, planes larger than the model do not support its poses
  bool operator==(const PoseTestOptions&) const = default;
};

/// A model whose poses are tested. It refers to its library.
struct TestedModel {
  const ModelInfo& info;
  kernels::ModelSamples samples;
  float distance_step = 0;  ///< see PpfQuantization
};

/// A model of a library. Errors: bad_data (its samples are damaged).
Result<TestedModel> tested_model(const Library& library, std::uint32_t model);

/// How likely a tested pose is, and how closely it fits the scan.
struct PoseFit {
  float score = 0;        ///< probability, 0..1
  float mean_square = 0;  ///< of its residuals (Examination::mean_square)
};

/// Whether a pose fits the scan much closer than another one and is about as likely: where
/// neighboring errors are correlated, or there are none, the score hardly rises with a closer fit.
bool fits_closer(const PoseFit& pose, const PoseFit& other) noexcept;

/// Tests poses of one model, whose library must outlive it, as must the scene and the options. Its
/// methods are thread-safe.
class PoseTester {
 public:
  PoseTester(const TestedModel& model, const PreparedScene& scene, const PoseTestOptions& options);
  PoseTester(const PoseTester&) = delete;
  PoseTester& operator=(const PoseTester&) = delete;

  const ModelInfo& model() const noexcept { return model_; }
  const PreparedScene& scene() const noexcept { return scene_; }
  const kernels::ModelSamples& samples() const noexcept { return samples_; }
  /// Options to verify a refined pose: with the sensor's error at its range.
  kernels::VerifyOptions strict(const Pose& pose) const;
  /// Options to verify a voted pose: with the tolerance of an unrefined one.
  kernels::VerifyOptions loose(const Pose& pose) const;

  /// What is measured across a surface may be off the model at this pose [library unit]: by the
  /// sensor's error at its range, and by the part's deviation from the model.
  float error_at(const Pose& pose) const;
  /// This error and the part shared by neighboring pixels, for comparing poses.
  kernels::MeasurementErrors errors_of(const Pose& pose) const;
  /// Possible displacement of this pose's outline in the scan [pixel].
  int edge_pixels(const Pose& pose) const;

  bool allowed(const Pose& pose) const {
    return options_.limits.allow(pose, model_.center, 1 / scene_.scale);
  }

  /// Refine a proposed pose with a part of the samples.
  Pose refined(const Pose& pose) const;
  /// Refine a proposed pose to no more than what lies within its tolerance. Where surfaces lie close
  /// to each other, as sheets in a heap, a pose keeps the one that it is proposed on.
  Pose refined_nearby(const Pose& pose) const;
  /// Refine a pose once more with all samples.
  Pose polished(const Pose& pose) const;

  /// Test a pose by rays. If the rays and the edges of the scan ask for a pose beside it that
  /// scores higher, the result is that one: see kernels::PoseEquations.
  TestedPose examine(const kernels::RayScene& surface, const kernels::ScoreModel& score,
                     const Pose& pose, kernels::ExamineScratch& scratch) const;
  /// Refine a pose once more with all samples, to all of the surface within its tolerance and to what
  /// lies within the sensor's error, and test both; the result is the second if it scores clearly
  /// higher.
  TestedPose polish_and_examine(const kernels::RayScene& surface, const kernels::ScoreModel& score,
                                const Pose& pose, kernels::ExamineScratch& scratch) const;
  /// Verdicts of the individual rays of that test.
  std::vector<kernels::JudgedRay> judged_rays(const kernels::RayScene& surface,
                                              const Pose& pose) const;

 private:
  kernels::ExamineOptions examine_options(const Pose& pose) const;
  TestedPose examine_once(const kernels::RayScene& surface, const kernels::ScoreModel& score,
                          const Pose& pose, kernels::ExamineScratch& scratch,
                          kernels::PoseEquations& equations) const;
  bool are_apart(const Pose& a, const Pose& b, float pixels) const;
  std::optional<Pose> solve(const Pose& pose, const kernels::PoseEquations& equations) const;
  const std::optional<Symmetry::Axis>& free_axis() const;
  Pose sharpened(const Pose& pose) const;
  kernels::RefineOptions narrowing(const Pose& pose) const;
  Pose refined(const Pose& pose, const kernels::RefineOptions& options) const;
  float range_of(const Pose& pose) const;
  std::uint8_t bearing_plane(const Pose& pose, float tolerance) const;
  kernels::PlaneSet open_planes(const Pose& pose, float tolerance) const;
  /// bearing  see VerifyOptions::bearing_plane
  float depth_in_ground(const Pose& pose, const FullTest& test, std::uint8_t bearing) const;
  /// Tolerance of residuals of a refined pose [library unit].
  float tolerance_at(const Pose& pose) const;
  /// Width of a pixel where the model is [scene unit].
  float pixel_at(const Pose& pose) const;

  const ModelInfo& model_;
  const PreparedScene& scene_;
  const PoseTestOptions& options_;
  kernels::ModelSamples samples_;
  float distance_step_;
  float deviation_;  // of the part from the model, root mean square [library unit]
  std::vector<std::uint8_t> background_;
  kernels::PlaneSet faces_;  // background planes that have something behind them somewhere
};

}  // namespace trivet::engine
