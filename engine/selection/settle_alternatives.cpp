#include "engine/selection/settle_alternatives.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "engine/poses/placement.hpp"
#include "engine/selection/odds.hpp"
#include "kernels/symmetry/turn_axis.hpp"
#include "kernels/verification/compare_poses.hpp"
#include "kernels/verification/compare_turns.hpp"
#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

constexpr float kAlternativePlace = 0.3F;  // [diameters]
constexpr float kLeastAlternativeScore = 0.1F;
constexpr float kAlternativeShare = 0.5F;  // share of the score of the ambiguous pose
constexpr int kMaxHops = 3;                // steps from an alternative to a better alternative
constexpr double kLeastLogOdds = -4.6;     // of alternatives that are noted: one in a hundred
constexpr float kSameAxis = 0.99F;         // cosine
constexpr double kLeastProbability = 1e-6;

class AmbiguityTest {
 public:
  AmbiguityTest(const PoseTester& tester, const kernels::RayScene& surface,
                const kernels::ScoreModel& score, const TestedPoses& poses)
      : tester_(tester), model_(tester.model()), surface_(surface), score_(score), poses_(poses) {}

  SettledPose settled(Row row) {
    SettledPose out;
    std::vector<Alike> alike;
    const kernels::TurnComparison turns = settle(row, out.pose, alike);
    note_alternatives(alike, turns, out);
    return out;
  }

  TestedPose best(Row row) {
    TestedPose pose;
    std::vector<Alike> alike;
    (void)settle(row, pose, alike);
    return pose;
  }

 private:
  /// A pose that the scan hardly distinguishes from another one.
  struct Alike {
    Pose T_scene_model;
    float score;
    double log_odds;  ///< log odds that the object lies like this rather than as the other one
  };

  /// Move the pose of a row to the best turn and alternative, and find the alternatives that are not
  /// distinguished from it. Returns how other turns compare with it.
  kernels::TurnComparison settle(Row row, TestedPose& pose, std::vector<Alike>& alike) {
    const PoseTable& table = poses_.table;
    const Row from = closest_fit(row);
    pose = {table.T_scene_model[from], table.score[from], table.test(from)};
    kernels::TurnComparison turns = settle_turn(pose);
    // Where neighboring errors are correlated, edges and creases appear displaced and scores err
    // alike: pixels alone decide, and only if they differ significantly.
    const auto correlation = static_cast<double>(tester_.scene().sensor.correlation);
    constexpr double kSignificant = kernels::PoseComparison::kSignificant;
    const double least_z = std::lerp(-kSignificant, kSignificant, correlation);
    for (int hop = 0; hop <= kMaxHops; ++hop) {
      alike.clear();
      std::optional<TestedPose> better;
      double most = 0;
      for (const Pose& alternative : alternatives_of(table.model[row], pose.T_scene_model)) {
        TestedPose tested = examine(alternative);
        if (same_placement(model_, tested.T_scene_model, pose.T_scene_model)) continue;
        const kernels::PoseComparison comparison =
            compare(tested.T_scene_model, pose.T_scene_model);
        const double log_odds = std::lerp(rival_log_odds(tested.score, pose.score, comparison),
                                          comparison.log_ratio, correlation);
        if (log_odds < kLeastLogOdds) continue;
        alike.push_back({tested.T_scene_model, tested.score, log_odds});
        if (log_odds > most && comparison.z > least_z) {
          most = log_odds;
          better = std::move(tested);
        }
      }
      if (!better || hop == kMaxHops || better->score < kAlternativeShare * pose.score) break;
      pose = *std::move(better);
      turns = settle_turn(pose);
    }
    return turns;
  }

  /// The row, or that of the same placement whose pose fits much closer and is about as likely.
  Row closest_fit(Row row) const {
    const PoseTable& table = poses_.table;
    const auto fit_of = [&](Row of) {
      return PoseFit{table.score[of], table.test(of).examination.mean_square};
    };
    Row closest = row;
    for (const Row other : poses_.rows) {
      if (table.model[other] == table.model[row] &&
          same_placement(model_, table.T_scene_model[row], table.T_scene_model[other]) &&
          fits_closer(fit_of(other), fit_of(closest)))
        closest = other;
    }
    return closest;
  }

  void note_alternatives(std::span<const Alike> alike, const kernels::TurnComparison& turns,
                         SettledPose& settled) {
    TestedPose& pose = settled.pose;
    Ambiguity& ambiguity = settled.ambiguity;
    // Likelihoods of the alternatives, and of those that the shape does not explain, relative to the
    // pose.
    double elsewhere = 0, strange = 0;
    for (const Alike& alternative : alike) {
      if (alternative.score < kAlternativeShare * pose.score) continue;
      const double likelihood = std::exp(alternative.log_odds);
      elsewhere += likelihood;
      ambiguity.alternatives.push_back(alternative.T_scene_model);
      if (!is_near_symmetric(pose.T_scene_model, alternative.T_scene_model)) strange += likelihood;
    }
    for (const float angle : turns.others) {
      const Pose turned = pose.T_scene_model * kernels::turn_about(*model_.near_axis, angle);
      if (examine(turned).score >= kAlternativeShare * pose.score)
        ambiguity.alternatives.push_back(turned);
    }
    pose.score = score_beside_strange(pose.score, static_cast<float>(strange / (1 + elsewhere)));
    ambiguity.pose_share = turns.share / static_cast<float>(1 + elsewhere);
    if (turns.high - turns.low > 2 * kRightRotationRad)
      ambiguity.turns = TurnExtent{*model_.near_axis, turns.low, turns.high};
  }

  kernels::PoseComparison compare(const Pose& pose, const Pose& with) {
    check_stop();
    return kernels::compare_poses(tester_.scene().images, {surface_, tester_.samples(), pose},
                                  {surface_, tester_.samples(), with}, tester_.errors_of(with),
                                  tester_.strict(with), compare_scratch_);
  }

  TestedPose examine(const Pose& pose) {
    check_stop();
    return tester_.examine(surface_, score_, pose, examine_scratch_);
  }

  /// Move to the turn about the axis of near symmetry that the scan supports best. Returns how the
  /// other turns compare with it.
  kernels::TurnComparison settle_turn(TestedPose& pose) {
    if (!model_.near_axis) return {};
    kernels::TurnComparison turns = kernels::compare_turns(
        tester_.scene().images, {surface_, tester_.samples(), pose.T_scene_model},
        {*model_.near_axis, turn_period(), kRightRotationRad},
        tester_.errors_of(pose.T_scene_model), tester_.strict(pose.T_scene_model),
        compare_scratch_);
    const bool far = std::abs(std::remainder(turns.best, turn_period())) >= kRightRotationRad;
    const Pose there = pose.T_scene_model * kernels::turn_about(*model_.near_axis, turns.best);
    TestedPose turned = examine(far ? tester_.polished(there) : there);
    // Displaced edges may support a turn that the full test contradicts.
    const bool doubtful = tester_.scene().sensor.correlation > 0 &&
                          compare(turned.T_scene_model, pose.T_scene_model).log_ratio +
                                  kernels::log_odds(turned.score, kLeastProbability) -
                                  kernels::log_odds(pose.score, kLeastProbability) <
                              0;
    if (doubtful && far) {
      turns.others.insert(turns.others.begin(), turns.best);
      turns.share = 1 - turns.share;
    }
    const float best = doubtful ? 0 : turns.best;
    turns.best = 0;
    for (float& other : turns.others) other -= best;
    turns.low -= best;
    turns.high -= best;
    if (!doubtful) pose = std::move(turned);
    return turns;
  }

  /// Period of turns about the axis of near symmetry [rad].
  float turn_period() const {
    const Eigen::Vector3f axis = model_.near_axis->direction;
    const auto turns = std::count_if(
        model_.symmetry.poses.begin(), model_.symmetry.poses.end(),
        [&](const Pose& motion) { return axis.dot(motion.linear() * axis) > kSameAxis; });
    return 2 * std::numbers::pi_v<float> / static_cast<float>(turns + 1);
  }

  /// Whether an alternative is the pose turned about the axis of near symmetry.
  bool is_turn(const Pose& pose, const Pose& alternative) const {
    if (!model_.near_axis) return false;
    const Eigen::Vector3f axis = model_.near_axis->direction;
    const float apart = (alternative * model_.center - pose * model_.center).norm();
    return (pose.linear() * axis).dot(alternative.linear() * axis) > std::cos(kRightRotationRad) &&
           apart <= kRightTranslation * model_.diameter;
  }

  /// Whether the model's shape explains why an alternative looks like the pose.
  bool is_near_symmetric(const Pose& pose, const Pose& alternative) const {
    return std::any_of(
        model_.near_symmetries.begin(), model_.near_symmetries.end(),
        [&](const Pose& motion) { return same_placement(model_, pose * motion, alternative); });
  }

  /// Other placements of the model that may look like this one, except turns about the axis of near
  /// symmetry.
  std::vector<Pose> alternatives_of(std::uint32_t model, const Pose& pose) const {
    std::vector<Pose> alternatives;
    const auto add = [&](const Pose& alternative) {
      const auto differs = [&](const Pose& known) {
        return !same_placement(model_, known, alternative);
      };
      if (tester_.allowed(alternative) && differs(pose) && !is_turn(pose, alternative) &&
          std::all_of(alternatives.begin(), alternatives.end(), differs))
        alternatives.push_back(alternative);
    };
    const PoseTable& table = poses_.table;
    for (const Row other : poses_.rows) {
      if (table.model[other] != model) continue;
      const Pose& there = table.T_scene_model[other];
      const float apart = (there * model_.center - pose * model_.center).norm();
      if (apart < kAlternativePlace * model_.diameter &&
          table.score[other] >= kLeastAlternativeScore)
        add(there);
    }
    for (const Pose& motion : model_.near_symmetries) {
      check_stop();
      add(tester_.polished(tester_.refined(pose * motion)));
    }
    return alternatives;
  }

  const PoseTester& tester_;
  const ModelInfo& model_;
  const kernels::RayScene& surface_;
  const kernels::ScoreModel& score_;
  const TestedPoses& poses_;
  kernels::ExamineScratch examine_scratch_;
  kernels::CompareScratch compare_scratch_;
};

/// Apply a method of AmbiguityTest to a row.
template <class Found>
Result<Found> tested_for_ambiguity(const Recognizer& recognizer, const TestedPoses& poses,
                                   const PoseTestOptions& options, Row row,
                                   Found (AmbiguityTest::*find)(Row)) {
  const std::uint32_t model = poses.table.model[row];
  const auto surface = recognizer.surface(model);
  if (!surface) return surface.error();
  TRIVET_TRY_ASSIGN(const TestedModel tested, tested_model(poses.library, model));
  const PoseTester tester(tested, poses.scene, options);
  AmbiguityTest test(tester, **surface, recognizer.score(), poses);
  return (test.*find)(row);
}

}  // namespace

Result<SettledPose> settle_alternatives(const Recognizer& recognizer, const TestedPoses& poses,
                                        const PoseTestOptions& options, Row row) {
  return tested_for_ambiguity(recognizer, poses, options, row, &AmbiguityTest::settled);
}

Result<TestedPose> find_best_alternative(const Recognizer& recognizer, const TestedPoses& poses,
                                         const PoseTestOptions& options, Row row) {
  return tested_for_ambiguity(recognizer, poses, options, row, &AmbiguityTest::best);
}

}  // namespace trivet::engine
