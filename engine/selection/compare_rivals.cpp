#include "engine/selection/compare_rivals.hpp"

#include <algorithm>

#include "engine/loaded_library/find_look_alikes.hpp"
#include "engine/poses/placement.hpp"
#include "engine/selection/odds.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kPosesOfRival = 4;

/// What compare_poses holds measurements against.
struct Limits {
  kernels::MeasurementErrors errors;
  kernels::VerifyOptions options;
};

Limits limits_of(const PoseTester& tester, const Pose& pose) {
  return {tester.errors_of(pose), tester.strict(pose)};
}

double measured(const kernels::PoseComparison& comparison) noexcept {
  return comparison.log_ratio - comparison.of_missing;
}

/// Log odds of a first model rather than a second one, each in that of two poses in which it is
/// likelier, from the log odds of each of its poses with each of the other's: `ab` is of the first
/// in pose a with the second in pose b. If they are differences of likelihoods, the order in which
/// the best poses are chosen does not matter; otherwise it is the mean of both orders.
double odds_of_best(double aa, double ab, double ba, double bb) noexcept {
  const double first_last = std::max(std::min(aa, ab), std::min(ba, bb));
  const double second_last = std::min(std::max(aa, ba), std::max(ab, bb));
  return 0.5 * (first_last + second_last);
}

}  // namespace

void add_rival(const TestedPoses& poses, Row row, std::vector<Row>& rivals) {
  const PoseTable& table = poses.table;
  const bool repeats = std::ranges::any_of(rivals, [&](Row other) {
    return same_placement(poses.library.models[table.model[row]], table.T_scene_model[other],
                          table.T_scene_model[row]);
  });
  if (!repeats && rivals.size() < kPosesOfRival) rivals.push_back(row);
}

Result<RivalComparison> compare_rivals(const Recognizer& recognizer, const PreparedScene& scene,
                                       const PoseTestOptions& test, const Rival& first,
                                       const Rival& second, kernels::CompareScratch& scratch) {
  const auto surface = recognizer.surface(first.model), other = recognizer.surface(second.model);
  if (!surface || !other) return surface ? other.error() : surface.error();
  TRIVET_TRY_ASSIGN(const TestedModel first_model, tested_model(recognizer.library(), first.model));
  TRIVET_TRY_ASSIGN(const TestedModel second_model,
                    tested_model(recognizer.library(), second.model));
  const PoseTester first_tester(first_model, scene, test), tester(second_model, scene, test);
  const Pose &here = second.T_scene_model, &there = first.T_scene_model;
  // The first at one pose with the second at another one, by the limits of the place of either.
  const Limits limits_here = limits_of(tester, here);
  const auto compare = [&](const Pose& pose, const Pose& other_pose, const Limits& limits) {
    return kernels::compare_poses(scene.images, {**surface, first_tester.samples(), pose},
                                  {**other, tester.samples(), other_pose}, limits.errors,
                                  limits.options, scratch);
  };
  RivalComparison out;
  out.T_second_first = here.inverse() * there;
  const kernels::RefinedAlignment common = kernels::refine_alignment(
      tester.samples(), first_tester.samples(), coinciding_distance(second_model.info.diameter),
      out.T_second_first);
  const kernels::PoseComparison apart = compare(there, here, limits_here);
  if (common.agreeing < kCoinciding) {
    out.log_odds = rival_log_odds(first.score, second.score, apart);
    out.num_measured = apart.num_measured;
    return out;
  }
  out.coincide = true;
  out.T_second_first = common.T_this_other;
  const Pose first_here = here * common.T_this_other,
             second_there = there * common.T_this_other.inverse();
  const kernels::PoseComparison both_here = compare(first_here, here, limits_here),
                                both_there =
                                    compare(there, second_there, limits_of(first_tester, there)),
                                crossed = compare(first_here, second_there, limits_here);
  out.log_odds =
      odds_of_best(measured(both_here), measured(crossed), measured(apart), measured(both_there));
  out.num_measured = both_here.num_measured;
  return out;
}

bool RivalComparisons::Before::operator()(const Rival& a, const Rival& b) const noexcept {
  if (a.model != b.model) return a.model < b.model;
  if (a.score != b.score) return a.score < b.score;
  const auto left = a.T_scene_model.matrix().reshaped(),
             right = b.T_scene_model.matrix().reshaped();
  return std::lexicographical_compare(left.begin(), left.end(), right.begin(), right.end());
}

Result<RivalComparison> RivalComparisons::of(const Rival& first, const Rival& second,
                                             kernels::CompareScratch& scratch) {
  {
    const std::lock_guard lock(mutex_);
    const OfFirst& made = made_[first];
    if (const auto known = made.find(second); known != made.end()) return known->second;
  }
  TRIVET_TRY_ASSIGN(const RivalComparison comparison,
                    compare_rivals(recognizer_, scene_, test_, first, second, scratch));
  const std::lock_guard lock(mutex_);
  made_[first].emplace(second, comparison);
  return comparison;
}

}  // namespace trivet::engine
