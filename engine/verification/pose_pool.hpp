/// From hypotheses to verified candidates, for all models of a scene together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/verification/candidate.hpp"
#include "engine/verification/model_stages.hpp"
#include "engine/verification/place_watch.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// What was proposed for one model.
struct ModelProposals {
  std::uint32_t model = 0;
  std::vector<Proposals> proposals;
};

/// What is done at most, over all models together, where evidence is best: counts, never clocks, so
/// that any number of threads gives the same.
struct PoseBudget {
  static constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
  std::size_t looked_at = kNoLimit;  ///< of what is added, those of most votes
  std::size_t refined = kNoLimit;    ///< of what is tested, by what a first look sees
  std::size_t examined = kNoLimit;   ///< ... by rays, by what the refined pose meets
};

/// A pose of a model that something already verified suggests.
struct SuggestedPose {
  std::uint32_t model = 0;
  Pose T_scene_model = Pose::Identity();
};

/// Poses that were looked at and wait for the full test: what a budget leaves over may have its turn
/// when better ones have explained their places.
class PosePool {
 public:
  /// All arguments are referred to.
  ///
  /// watch  is told what comes to which stage; null: nobody is
  PosePool(const Recognizer& recognizer, const PreparedScene& scene, const SettleOptions& options,
           StageTimes& times, PlaceWatch* watch);
  ~PosePool();

  /// Cluster the hypotheses of each model, and look at each cluster. Errors: bad_data (damaged).
  Result<void> add(std::span<const ModelProposals> proposals, const PoseBudget& budget);

  /// Models of the poses that looked best when they were added, so many at most, rising: those that
  /// a closer search may find. Poses on explained pixels do not count.
  std::vector<std::uint32_t> likely_models(std::size_t limit,
                                           std::span<const std::uint8_t> explained) const;

  /// Refine the best of what waits, test those by rays and score them; none waits any more. Those
  /// that lie on explained pixels are given up.
  ///
  /// explained  nonzero for such pixels, of all images one after the other; empty: none
  /// Returns candidates by model. Errors: internal (no memory for a model's ray-tracing tree), bad_data (damaged),
  /// resumable (stopped).
  Result<std::vector<Candidate>> test_best(const PoseBudget& budget,
                                           std::span<const std::uint8_t> explained = {});

  /// Refine and test suggested poses: of each list the `examined` that the scene speaks for most.
  /// Errors: as above.
  Result<std::vector<Candidate>> test(std::span<const std::vector<SuggestedPose>> lists,
                                      std::size_t examined);

  /// What each ray of the full test says of a pose as it is. Errors: internal and bad_data, as above.
  Result<std::vector<kernels::JudgedRay>> judged_rays(const SuggestedPose& suggested);

  std::size_t num_looked_at() const noexcept;
  std::size_t num_refined() const noexcept;
  std::size_t num_examined() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trivet::engine
