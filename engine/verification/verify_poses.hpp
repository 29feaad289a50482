/// Verification of a scene's poses, stage by stage, as functions over rows of their table.
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
  bool visibility = true;  ///< whether samples score poses; otherwise votes do
  bool contour = true;     ///< whether a scene that continues beyond the outline lowers the score
  bool rays = true;        ///< whether rays test the final poses; otherwise all samples do
  bool operator==(const VerificationOptions&) const = default;
};

/// Verifies poses. The rows of a call are verified in parallel, and each changes its own row only.
/// The models of the rows must have been prepared.
class PoseVerifier {
 public:
  /// Keeps references to all arguments.
  PoseVerifier(const Recognizer& recognizer, const PreparedScene& scene,
               const VerificationOptions& options, StageTimes& times);

  /// Prepare the verification of poses of these models. Errors: bad_data (a model's samples are
  /// damaged).
  Result<void> prepare(std::span<const std::uint32_t> models);
  /// Pre: the model is prepared.
  const PoseTester& tester(std::uint32_t model) const { return *testers_[model]; }

  /// Score poses by a part of their samples, with the tolerance of an unrefined pose.
  void screen(PoseTable& table, std::span<const Row> rows) const;
  /// Lower the scores of unrefined poses if the scene continues beyond their outline.
  void judge_contours(PoseTable& table, std::span<const Row> rows) const;
  /// Refine poses with a part of the samples, from afar and to what lies nearby, and score them by
  /// all samples with the tolerance of a refined pose. Of both, the second remains if its score is
  /// much higher.
  void refine(PoseTable& table, std::span<const Row> rows) const;
  /// Refine poses once more with all samples and test them by rays. Returns the rows of the poses
  /// within the limits; the others are discarded.
  /// Errors: internal (no memory for a model's ray-tracing tree), damaged.
  Result<std::vector<Row>> examine(PoseTable& table, std::span<const Row> rows) const;
  /// The scores that `examine` would give; the table stays as it is.
  Result<std::vector<float>> full_scores(const PoseTable& table, std::span<const Row> rows) const;

  /// Nonzero, by row, where most of the pixels met by a part of the proposed pose's samples are
  /// marked.
  ///
  /// marked  one value per pixel over all images; empty: no pixel is marked
  std::vector<std::uint8_t> lie_on(const PoseTable& table, std::span<const Row> rows,
                                   std::span<const std::uint8_t> marked) const;
  /// Verdict of each ray of the full test of a pose. Errors: as for examine.
  Result<std::vector<kernels::JudgedRay>> judged_rays(std::uint32_t model,
                                                      const Pose& T_scene_model) const;

 private:
  // Keyed by model.
  using Surfaces = std::map<std::uint32_t, std::shared_ptr<const kernels::RayScene>>;

  Result<std::vector<TestedPose>> test(const PoseTable& table, std::span<const Row> rows) const;
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
  std::vector<std::unique_ptr<const PoseTester>> testers_;  // by model; null: not prepared
};

}  // namespace trivet::engine
