/// The poses of one scene on their way from proposal to detection: a row a pose.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/results/explanation.hpp"
#include "engine/results/recognize_result.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "kernels/verification/pose_score.hpp"
#include "kernels/verification/verify_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet::engine {

/// Index of a pose in a table; it stays the same.
using Row = std::uint32_t;

/// What was decided of a pose.
enum class PoseFate : std::uint8_t {
  open,       ///< nothing yet
  given_up,   ///< it was not tested in full, or moved beyond the limits: others were likelier
  detection,  ///< it is reported
  too_low,    ///< its score is below what is asked for
  explained,  ///< better poses explain its pixels
  too_many,   ///< its model has better instances, as many as are asked for
};

/// What the full test says of a pose.
struct FullTest {
  float tolerance = 0;  ///< that the pose was examined with [library unit]
  kernels::Examination examination{};
  kernels::ScoreParts parts{};
  kernels::ExplainedPixels explained{};  ///< over all images
};

/// A pose as the full test leaves it.
struct TestedPose {
  Pose T_scene_model = Pose::Identity();
  float score = 0;  ///< probability of being right, 0..1
  FullTest test{};
};

/// What the scan cannot tell from a pose.
struct Ambiguity {
  std::vector<Pose> alternatives;
  float pose_share = 1;  ///< of the score that is this pose's, the rest its alternatives', 0..1
  std::vector<std::uint32_t> siblings;  ///< models that it may be as well
  std::optional<TurnExtent> turns;  ///< about the model's near axis, if more than one is as likely
};

/// A pose that was compared with all that looks like it.
struct SettledPose {
  TestedPose pose;
  Ambiguity ambiguity;
};

/// One column a property, all of the same length but the last three, which only tested poses have.
/// Stages change columns of the rows that they are given; rows are never moved or removed.
struct PoseTable {
  std::vector<std::uint32_t> model;  ///< of the library
  std::vector<Source> source;        ///< that proposed it
  std::vector<Pose> T_proposed;      ///< T_scene_model as it was proposed
  std::vector<Pose> T_scene_model;   ///< as the last stage left it
  std::vector<float> votes;
  std::vector<float> share;                 ///< of the votes that its source has for the model
  std::vector<kernels::Evidence> evidence;  ///< by samples of the surface
  std::vector<float> screen_score;          ///< of the pose as it was proposed, by samples
  std::vector<float> score;  ///< as the last stage left it; of a tested pose its probability
  std::vector<PoseStage> stage;
  std::vector<PoseFate> fate;
  std::vector<std::optional<Row>> explained_by;  ///< the pose that explains most of its pixels
  std::vector<float> explained_share;            ///< ... and what share of them
  std::vector<std::uint32_t> test_index;         ///< into the columns below, once it is tested
  std::vector<FullTest> tests;
  std::vector<Ambiguity> ambiguities;

  std::size_t size() const noexcept { return model.size(); }
  const FullTest& test(Row row) const { return tests[test_index[row]]; }
  const Ambiguity& ambiguity(Row row) const { return ambiguities[test_index[row]]; }

  /// Append a pose. Returns its row.
  Row add(std::uint32_t of_model, Source proposed_by, const Pose& pose, float num_votes = 0,
          float vote_share = 0);
  /// Record what the full test, or the comparison with what looks alike, made of a pose.
  void set_tested(Row row, TestedPose tested);
  void set_settled(Row row, SettledPose settled);
};

/// The rows by falling value of a column, ties in their order.
std::vector<Row> by_falling(std::span<const float> column, std::span<const Row> rows);

/// Take the `limit` rows of the largest values out of `rows`; these and the rest keep their order.
std::vector<Row> take_best(std::span<const float> column, std::size_t limit,
                           std::vector<Row>& rows);

}  // namespace trivet::engine
