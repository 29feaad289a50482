/// Verification of a scene's poses, stage by stage: functions over rows of their table.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/options/recognize_options.hpp"
#include "engine/poses/pose_table.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/verification/pose_tester.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

struct VerificationOptions {
  PoseTestOptions test{};
  bool visibility = true;  ///< poses are scored by what their samples meet, else by votes
  bool contour = true;     ///< ... and by where the scene runs on beyond their outline
  bool rays = true;        ///< the last ones are tested by rays, else by all samples
  bool operator==(const VerificationOptions&) const = default;
};

/// Rows of a call are verified side by side; each changes its own row alone. The models of the rows
/// must have been prepared.
class PoseVerifier {
 public:
  /// All arguments are referred to.
  PoseVerifier(const Recognizer& recognizer, const PreparedScene& scene,
               const VerificationOptions& options, StageTimes& times);

  /// Get ready to verify poses of these models. Errors: bad_data (a model's samples are damaged).
  Result<void> prepare(std::span<const std::uint32_t> models);
  /// Of a prepared model.
  const PoseTester& tester(std::uint32_t model) const { return *testers_.at(model); }

  /// Score poses by what some samples of them meet, with the tolerance of an unrefined pose.
  void screen(PoseTable& table, std::span<const Row> rows) const;
  /// Lower the scores of unrefined poses beyond whose outline the scene runs on.
  void judge_contours(PoseTable& table, std::span<const Row> rows) const;
  /// Refine poses with some samples, and score them by all with the tolerance of a refined pose.
  void refine(PoseTable& table, std::span<const Row> rows) const;
  /// Refine poses once more with all samples and test them by rays. Returns the rows of those that
  /// are within the limits; the others are given up.
  /// Errors: internal (no memory for a model's ray-tracing tree), bad_data (damaged).
  Result<std::vector<Row>> examine(PoseTable& table, std::span<const Row> rows) const;

  /// By row, nonzero where most of what some samples of the proposed pose meet is marked.
  ///
  /// marked  one a pixel over all images; empty: nothing is
  std::vector<std::uint8_t> lie_on(const PoseTable& table, std::span<const Row> rows,
                                   std::span<const std::uint8_t> marked) const;
  /// What each ray of the full test says of a pose. Errors: as of examine.
  Result<std::vector<kernels::JudgedRay>> judged_rays(std::uint32_t model,
                                                      const Pose& T_scene_model) const;

 private:
  using Surfaces = std::map<std::uint32_t, std::shared_ptr<const kernels::RayScene>>;  // by model

  Result<Surfaces> surfaces_of(const PoseTable& table, std::span<const Row> rows) const;
  TestedPose judged_by_samples(const PoseTester& tester, const Pose& pose, float score) const;
  void score_by_samples(const PoseTester& tester, std::size_t num_samples,
                        const kernels::VerifyOptions& how, PoseTable& table, Row row) const;
  void score_by_contour(const PoseTester& tester, const kernels::VerifyOptions& how,
                        kernels::ContourScratch& scratch, PoseTable& table, Row row) const;

  const Recognizer& recognizer_;
  const PreparedScene& scene_;
  const VerificationOptions& options_;
  StageTimes& times_;
  std::map<std::uint32_t, std::unique_ptr<const PoseTester>> testers_;  // by model
};

}  // namespace trivet::engine
