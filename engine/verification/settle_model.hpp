/// From the hypotheses of one model to verified candidates.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/hypotheses/prepare_scene.hpp"
#include "engine/recognize.hpp"
#include "engine/recognizer.hpp"
#include "engine/verification/candidate.hpp"
#include "engine/verification/pose_tester.hpp"
#include "kernels/verification/cluster_poses.hpp"
#include "storage/result.hpp"

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

struct SettledModel {
  std::vector<Candidate> candidates;
  std::size_t num_hypotheses = 0, num_refined = 0, num_examined = 0;
};

/// Cluster the hypotheses of one model, those of each source for themselves, look at each, refine
/// the best of all, test those by rays and score them. `step` is the sampling step of the points
/// that voted. Errors: internal (no memory for the model's ray-tracing tree).
Result<SettledModel> settle_model(const Recognizer& recognizer, std::uint32_t model_index,
                                  const PreparedScene& scene, float step,
                                  std::span<const Proposals> proposals,
                                  const SettleOptions& options, StageTimes& times);

}  // namespace trivet::engine
