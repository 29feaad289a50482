/// Table of the poses of one scene on their way from proposal to detection, one row per pose.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/results/explanation.hpp"
#include "engine/results/recognize_result.hpp"
#include "kernels/scoring/pose_score.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "kernels/verification/pose_covariance.hpp"
#include "kernels/verification/verify_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet::engine {

/// Index of a pose in the table. It never changes.
using Row = std::uint32_t;

/// Decision on a pose.
enum class PoseFate : std::uint8_t {
  open,       ///< none yet
  given_up,   ///< discarded: beyond the limits, or not tested in full since others were likelier
  detection,  ///< reported
  too_low,    ///< score below the required minimum
  explained,  ///< pixels explained by better poses
  too_many,   ///< the model already has the maximum number of better instances
};

/// Result of the full test of a pose.
struct FullTest {
  kernels::Examination examination{};
  float largest_tolerance = 0;  ///< of residuals, before the pose's own lowered it [library unit]
  kernels::ScoreParts parts{};
  /// How deep the model would be in a table, a floor or a wall that has no hole there [library
  /// unit]; such a pose is refused. 0: not at all.
  float depth_in_ground = 0;
  kernels::PoseCovariance covariance = kernels::PoseCovariance::Zero();  ///< [library unit, rad]
  kernels::ExplainedPixels explained{};                                  ///< over all images
};

/// A pose after the full test.
struct TestedPose {
  Pose T_scene_model = Pose::Identity();
  float score = 0;  ///< probability of being correct, 0..1
  FullTest test{};
};

/// A model that may be what lies at a place.
struct PosedCandidate {
  std::uint32_t model = 0;  ///< index in the library
  float share = 1;          ///< probability that it is this one, if it is one of the candidates
  float score = 0;          ///< its own, as tested
  Pose T_scene_model = Pose::Identity();
  /// As it was compared with the first candidate: its model in that one's frame.
  Pose T_first_model = Pose::Identity();
  double log_odds = 0;           ///< that it is here rather than the first candidate, <= 0
  std::size_t num_measured = 0;  ///< rays that tell it from the first candidate
};

/// Hypotheses that the scan cannot distinguish from a pose.
struct Ambiguity {
  std::vector<Pose> alternatives;
  /// Share of the score of this exact pose; its alternatives share the rest, 0..1.
  float pose_share = 1;
  /// Models that the object may be by falling share, the pose's own first; empty if poses were not
  /// compared.
  std::vector<PosedCandidate> candidates;
  /// Turns about the model's axis of near symmetry, if several are equally likely.
  std::optional<TurnExtent> turns;

  /// Share of the pose's own model.
  float identity() const noexcept { return candidates.empty() ? 1 : candidates.front().share; }
};

/// A pose after comparison with all hypotheses that look like it.
struct SettledPose {
  TestedPose pose;
  Ambiguity ambiguity;
};

/// One column per property. All have the same length except the last three, which contain tested
/// poses only. Stages change columns of the rows that they are given; rows are never moved or
/// removed.
struct PoseTable {
  std::vector<std::uint32_t> model;  ///< index in the library
  std::vector<Source> source;        ///< source that proposed the pose
  std::vector<Pose> T_proposed;      ///< T_scene_model as proposed
  std::vector<Pose> T_scene_model;   ///< pose after the latest stage
  std::vector<float> votes;
  std::vector<float> share;                 ///< share of its source's votes for the model
  std::vector<kernels::Evidence> evidence;  ///< evidence by samples of the surface
  std::vector<float> screen_score;          ///< score of the proposed pose, by samples
  std::vector<float> score;  ///< score after the latest stage; for a tested pose its probability
  std::vector<PoseStage> stage;
  std::vector<PoseFate> fate;
  std::vector<std::optional<Row>> explained_by;  ///< pose that explains most of its pixels
  std::vector<float> explained_share;            ///< share of its pixels that this pose explains
  std::vector<std::uint32_t> test_index;         ///< index into the columns below, for tested poses
  std::vector<FullTest> tests;
  std::vector<Ambiguity> ambiguities;

  std::size_t size() const noexcept { return model.size(); }
  const FullTest& test(Row row) const { return tests[test_index[row]]; }
  const Ambiguity& ambiguity(Row row) const { return ambiguities[test_index[row]]; }

  /// Append a pose, which may be one of the table's own. Returns its row.
  Row add(std::uint32_t of_model, Source proposed_by, const Pose& pose, float num_votes = 0,
          float vote_share = 0);
  /// Record the result of the full test, or of the comparison with similar hypotheses.
  void set_tested(Row row, TestedPose tested);
  void set_settled(Row row, SettledPose settled);
};

/// Sort rows by falling value of a column, ties in their order.
std::vector<Row> by_falling(std::span<const float> column, std::span<const Row> rows);

/// Remove the `limit` rows with the largest values from `rows`. These and the rest keep their
/// order.
std::vector<Row> extract_best(std::span<const float> column, std::size_t limit,
                              std::vector<Row>& rows);

}  // namespace trivet::engine
