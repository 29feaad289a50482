#include "engine/selection/settle_alternatives.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "kernels/symmetry/turn_axis.hpp"
#include "kernels/verification/compare_poses.hpp"
#include "kernels/verification/compare_turns.hpp"
#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

constexpr float kAlternativePlace = 0.3F;  // in diameters
constexpr float kLeastAlternativeScore = 0.1F;
constexpr float kAlternativeShare = 0.5F;  // of the score of the pose that is ambiguous
constexpr int kMaxHops = 3;                // from alternative to better alternative
// In standard deviations, three to one, where pixels err for themselves. Where neighbors err alike
// edges and creases are shown beside their places: an alternative must be significantly better.
constexpr double kTelling = 0.7;
constexpr float kSameAxis = 0.99F;  // cosine
// Of a pose that might as well lie in its place in a way that its shape does not explain. What is
// not there often does: of detections from 0.8 on, in the drawn scenes of scripts/calibrate, 39 of
// 670 right ones and 48 of 143 wrong ones.
constexpr float kOddsOfStrangeAlternative = 0.4F;

double alternative_odds(float probability) noexcept {
  constexpr double kLeast = 1e-6;
  const double p = std::clamp(static_cast<double>(probability), kLeast, 1 - kLeast);
  return std::log(p / (1 - p));
}

class AmbiguityTest {
 public:
  AmbiguityTest(const PoseTester& tester, const kernels::RayScene& surface,
                const kernels::ScoreModel& score, std::span<const Candidate> candidates)
      : tester_(tester),
        model_(tester.model()),
        surface_(surface),
        score_(score),
        candidates_(candidates) {}

  void settle(Candidate& candidate) {
    kernels::TurnComparison turns = settle_turn(candidate);
    const double telling = std::lerp(kTelling, kernels::PoseComparison::kSignificant,
                                     static_cast<double>(tester_.scene().sensor.correlation));
    std::vector<Alike> alike;
    for (int hop = 0; hop <= kMaxHops; ++hop) {
      alike.clear();
      std::optional<Pose> better;
      double most = 0;
      for (const Pose& alternative : alternatives_of(candidate)) {
        const kernels::PoseComparison comparison = compare(alternative, candidate);
        if (comparison.log_ratio > most && comparison.z > telling) {
          most = comparison.log_ratio;
          better = alternative;
        }
        if (!comparison.significant()) alike.push_back({alternative, comparison.log_ratio});
      }
      if (!better || hop == kMaxHops) break;
      Candidate moved = examine(*better, candidate);
      if (moved.score < kAlternativeShare * candidate.score) break;
      candidate = std::move(moved);
      turns = settle_turn(candidate);
    }
    double elsewhere = 0;  // likelihood of alternatives over that of the pose
    bool strange = false;
    for (const Alike& alternative : alike) {
      if (!is_alternative(alternative.T_scene_model, candidate)) continue;
      elsewhere += std::exp(alternative.log_ratio);
      candidate.alternatives.push_back(alternative.T_scene_model);
      strange = strange || !is_near_symmetric(candidate.T_scene_model, alternative.T_scene_model);
    }
    for (const float angle : turns.others) {
      const Pose turned = candidate.T_scene_model * kernels::turn_about(*model_.near_axis, angle);
      if (is_alternative(turned, candidate)) candidate.alternatives.push_back(turned);
    }
    if (strange) candidate.score = scale_odds(candidate.score, kOddsOfStrangeAlternative);
    candidate.pose_share = turns.share / static_cast<float>(1 + elsewhere);
    if (turns.high - turns.low > 2 * kRightRotationRad)
      candidate.turns = TurnExtent{*model_.near_axis, turns.low, turns.high};
  }

 private:
  /// A pose that the scan cannot tell from another one.
  struct Alike {
    Pose T_scene_model;
    double log_ratio;  ///< of its likelihood over that of the other one
  };

  kernels::PoseComparison compare(const Pose& pose, const Candidate& with) {
    check_stop();
    return kernels::compare_poses(tester_.scene().images, {surface_, tester_.samples(), pose},
                                  {surface_, tester_.samples(), with.T_scene_model},
                                  tester_.errors_of(with.T_scene_model),
                                  tester_.strict(with.T_scene_model), compare_scratch_);
  }

  bool is_alternative(const Pose& pose, const Candidate& candidate) {
    return examine(pose, candidate).score >= kAlternativeShare * candidate.score;
  }

  Candidate examine(const Pose& pose, const Candidate& instead_of) {
    check_stop();
    Candidate candidate = tester_.examine(surface_, score_, pose, examine_scratch_);
    candidate.model = instead_of.model;
    candidate.source = instead_of.source;
    return candidate;
  }

  /// Move to the turn about the near axis that the scan speaks for. Returns how the others compare
  /// with that one.
  kernels::TurnComparison settle_turn(Candidate& candidate) {
    if (!model_.near_axis) return {};
    kernels::TurnComparison turns =
        kernels::compare_turns(tester_.scene().images, surface_, tester_.samples(),
                               candidate.T_scene_model, *model_.near_axis, turn_period(),
                               kRightRotationRad, tester_.errors_of(candidate.T_scene_model),
                               tester_.strict(candidate.T_scene_model), compare_scratch_);
    const bool far = std::abs(std::remainder(turns.best, turn_period())) >= kRightRotationRad;
    const Pose there = candidate.T_scene_model * kernels::turn_about(*model_.near_axis, turns.best);
    Candidate turned = examine(far ? tester_.polished(there) : there, candidate);
    // Edges that lie beside their places may speak for a turn that the whole test speaks against.
    const bool doubtful = tester_.scene().sensor.correlation > 0 &&
                          compare(turned.T_scene_model, candidate).log_ratio +
                                  alternative_odds(turned.score) -
                                  alternative_odds(candidate.score) <
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
    if (!doubtful) candidate = std::move(turned);
    return turns;
  }

  /// Turns by it about the near axis are symmetries [rad].
  float turn_period() const {
    const Eigen::Vector3f axis = model_.near_axis->direction;
    const auto turns = std::count_if(
        model_.symmetry.poses.begin(), model_.symmetry.poses.end(),
        [&](const Pose& motion) { return axis.dot(motion.linear() * axis) > kSameAxis; });
    return 2 * std::numbers::pi_v<float> / static_cast<float>(turns + 1);
  }

  /// Whether an alternative is the pose turned about the near axis.
  bool is_turn(const Pose& pose, const Pose& alternative) const {
    if (!model_.near_axis) return false;
    const Eigen::Vector3f axis = model_.near_axis->direction;
    const float apart = (alternative * model_.center - pose * model_.center).norm();
    return (pose.linear() * axis).dot(alternative.linear() * axis) > std::cos(kRightRotationRad) &&
           apart <= kRightTranslation * model_.diameter;
  }

  /// Whether the model's shape explains that an alternative looks like the pose.
  bool is_near_symmetric(const Pose& pose, const Pose& alternative) const {
    return std::any_of(
        model_.near_symmetries.begin(), model_.near_symmetries.end(),
        [&](const Pose& motion) { return same_placement(model_, pose * motion, alternative); });
  }

  /// Other placements of the model that may look like this one, but turns about the near axis.
  std::vector<Pose> alternatives_of(const Candidate& candidate) const {
    const Pose& pose = candidate.T_scene_model;
    std::vector<Pose> alternatives;
    const auto add = [&](const Pose& alternative) {
      const auto differs = [&](const Pose& known) {
        return !same_placement(model_, known, alternative);
      };
      if (tester_.allowed(alternative) && differs(pose) && !is_turn(pose, alternative) &&
          std::all_of(alternatives.begin(), alternatives.end(), differs))
        alternatives.push_back(alternative);
    };
    for (const Candidate& other : candidates_) {
      if (other.model != candidate.model) continue;
      const float apart = (other.T_scene_model * model_.center - pose * model_.center).norm();
      if (apart < kAlternativePlace * model_.diameter && other.score >= kLeastAlternativeScore)
        add(other.T_scene_model);
    }
    for (const Pose& motion : model_.near_symmetries) {
      check_stop();
      add(tester_.polished(tester_.refined(pose * motion)));
    }
    return alternatives;
  }

  const PoseTester& tester_;
  const Model& model_;
  const kernels::RayScene& surface_;
  const kernels::ScoreModel& score_;
  std::span<const Candidate> candidates_;
  kernels::ExamineScratch examine_scratch_;
  kernels::CompareScratch compare_scratch_;
};

}  // namespace

Result<void> settle_alternatives(const Recognizer& recognizer, const PreparedScene& scene,
                                 float step, std::span<const Candidate> candidates,
                                 const PoseTestOptions& options, Candidate& candidate) {
  const auto surface = recognizer.surface(candidate.model);
  if (!surface) return surface.error();
  const PoseTester tester(recognizer.library().models[candidate.model], scene, step, options);
  AmbiguityTest(tester, **surface, recognizer.score(), candidates).settle(candidate);
  return {};
}

}  // namespace trivet::engine
