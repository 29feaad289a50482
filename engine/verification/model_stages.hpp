/// One model in one scene: what each of its poses goes through.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/options/recognize_options.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/verification/candidate.hpp"
#include "engine/verification/pose_tester.hpp"
#include "kernels/verification/cluster_poses.hpp"

namespace trivet::engine {

/// Poses of one model, all from one source.
struct Proposals {
  Source source = Source::ppf;
  std::vector<kernels::Hypothesis> hypotheses;
};

struct SettleOptions {
  PoseOptions pose{};
  PoseTestOptions test{};
  bool visibility = true;  ///< poses are scored by what their samples meet, else by votes
  bool contour = true;     ///< ... and by where the scene runs on beyond their outline
  bool rays = true;        ///< the last ones are tested by rays, else by all samples
  bool operator==(const SettleOptions&) const = default;
};

/// A pose after coarse verification: by samples of the surface.
struct CoarsePose {
  Source source = Source::ppf;
  Pose T_scene_model = Pose::Identity();
  float votes = 0;  ///< for it
  float share = 0;  ///< ... of all that its source has for the model
  kernels::Evidence evidence{};
  float score = 0;
};

/// Contours judged per candidate refined.
inline constexpr std::size_t kContourShare = 3;

/// All arguments must outlive it. Its methods may be called from many threads.
class ModelStages {
 public:
  ModelStages(const Recognizer& recognizer, std::uint32_t model, const PreparedScene& scene,
              const SettleOptions& options);

  std::uint32_t index() const noexcept { return index_; }
  const Model& model() const noexcept { return model_; }

  /// The clusters of all proposals, those of each source for themselves, not verified yet.
  std::vector<CoarsePose> cluster(std::span<const Proposals> proposals) const;
  /// Coarse verification with the tolerance of an unrefined pose.
  void look(CoarsePose& pose) const;
  /// Those whose contours are judged: it only lowers a score, and costs more.
  std::vector<CoarsePose> in_the_running(std::span<const CoarsePose> looked_at) const;
  void judge_contour(CoarsePose& pose, kernels::ContourScratch& scratch) const;
  /// Those to refine: half by what is seen, half by votes, since what lies end-on or deep looks
  /// worse than it is.
  std::vector<CoarsePose> preselect(std::span<const CoarsePose> judged) const;
  /// Refined with some samples, and verified with the tolerance of a refined pose.
  void refine(CoarsePose& pose) const;
  void verify(CoarsePose& pose, kernels::ContourScratch& scratch) const;
  /// Those to test by rays.
  std::vector<CoarsePose> hopeful(std::span<const CoarsePose> verified) const;
  /// Refine once more with all samples, and test by rays; nothing where the limits do not allow
  /// what comes of it.
  std::optional<Candidate> examine(const kernels::RayScene& surface,
                                   const kernels::ScoreModel& score, const CoarsePose& pose,
                                   kernels::ExamineScratch& scratch) const;
  const PoseTester& tester() const noexcept { return tester_; }
  /// Whether most of what some samples of the pose meet is marked.
  ///
  /// marked  one a pixel over all images
  bool is_marked(const CoarsePose& pose, std::span<const std::uint8_t> marked) const;

 private:
  Candidate judged_by_samples(const CoarsePose& pose) const;
  void verify_coarsely(std::size_t num_samples, const kernels::VerifyOptions& options,
                       CoarsePose& pose) const;
  void judge_contour(const kernels::VerifyOptions& options, kernels::ContourScratch& scratch,
                     CoarsePose& pose) const;

  const std::uint32_t index_;
  const Model& model_;
  const PoseTester tester_;
  const PreparedScene& scene_;
  const SettleOptions& options_;
};

}  // namespace trivet::engine
