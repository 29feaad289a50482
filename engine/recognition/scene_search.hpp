/// The search of one scene: rounds of proposals, and the choice among all that was verified.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <stop_token>
#include <vector>

#include "engine/hypotheses/match_features.hpp"
#include "engine/hypotheses/prepare_scene.hpp"
#include "engine/recognize.hpp"
#include "engine/recognizer.hpp"
#include "engine/verification/candidate.hpp"
#include "engine/verification/select_detections.hpp"
#include "engine/verification/settle_model.hpp"
#include "storage/result.hpp"

namespace trivet::engine {

/// Models of one sampling step: they share the sampled scene and its pair features.
using ModelGroups = std::map<float, std::vector<std::uint32_t>>;

class SceneSearch {
 public:
  /// All arguments but the stop token are referred to.
  SceneSearch(const Recognizer& recognizer, const PreparedScene& scene, const ModelGroups& groups,
              const RecognizeOptions& options, std::stop_token stop, SceneStats& stats);

  /// Test the expected poses. Errors: as search().
  Result<void> test_expected();

  /// Search for what is not yet explained. Errors: internal (no memory for ray tracing), resumable
  /// (stopped).
  Result<void> search(std::uint32_t round);

  /// The chosen candidates in the order of choice, held against their alternatives. Those that move
  /// to where another one lies are refused, and those below the scores that are asked for. Errors:
  /// internal.
  Result<std::vector<Candidate>> chosen();

  const std::vector<Candidate>& candidates() const noexcept { return candidates_; }
  const Selection& selection() const noexcept { return selection_; }

 private:
  /// By model of the library.
  using AllProposals = std::vector<std::vector<Proposals>>;

  void vote(std::uint32_t round, AllProposals& proposals);
  void match(AllProposals& proposals);
  Result<void> settle(const AllProposals& proposals);
  SceneSample sample(float step, std::span<const std::uint32_t> models) const;
  Result<std::vector<Candidate>> settle_alternatives(std::span<const std::uint32_t> chosen);
  /// Whether matches propose a pose that votes had the chance to propose and did not.
  bool is_beside_votes(const Candidate& candidate) const;
  bool lies_at_one_of(std::span<const Candidate> better, const Candidate& candidate) const;

  const Recognizer& recognizer_;
  const Library& library_;
  const PreparedScene& scene_;
  const ModelGroups& groups_;
  const RecognizeOptions& options_;
  std::stop_token stop_;
  SceneStats& stats_;
  std::vector<SceneSample> samples_;   // one a group of models, from the first round on
  std::vector<SceneMatches> matches_;  // one a level of features, once they are matched
  bool matched_ = false;
  std::vector<Candidate> candidates_;
  Selection selection_;
};

}  // namespace trivet::engine
