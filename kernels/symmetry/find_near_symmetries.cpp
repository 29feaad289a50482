#include "kernels/symmetry/find_near_symmetries.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "kernels/common/pose_math.hpp"
#include "kernels/surfaces/visibility.hpp"
#include "kernels/symmetry/angles.hpp"
#include "kernels/symmetry/turn_axis.hpp"
#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

constexpr float kRadiansPerDegree = std::numbers::pi_v<float> / 180;
constexpr std::size_t kMinSurface = 200;
constexpr int kNumTurns = 10000;            // 8 degrees apart; refinement reaches 20 and more
constexpr float kMaxScreen = 0.045F;        // limit of TurnScreen's score, which is capped at 0.06
constexpr std::size_t kMaxCompared = 2000;  // rotations compared with each other
constexpr std::size_t kMaxRefined = 24;
constexpr float kStartsApart = 30 * kRadiansPerDegree;
constexpr float kTurned = 20 * kRadiansPerDegree;
constexpr float kAround = 15 * kRadiansPerDegree;
constexpr float kBetter = 0.02F;                    // smallest significant improvement of a rating
constexpr float kSameTurn = 6 * kRadiansPerDegree;  // refined rotations this near are the same
constexpr float kSameShift = 0.03F;                 // [diameters]
constexpr float kOnSurface = 0.02F;                 // [diameters]
constexpr float kMinAlike = 0.65F;  // smallest share of the samples visible in a view
constexpr float kMinShare = 0.45F;  // smallest share of all samples
constexpr std::size_t kViewsAlike = kNumViews / 4;  // number of views that must be as alike
constexpr std::size_t kMaxFound = 8;
static_assert(kMaxFound <= kMaxNearSymmetries);
// Share of all samples that the least similar rotation about an axis must keep: flanges keep 86 %
// and more, gears 81, mugs 78; nuts 65, boxes 60 and less.
constexpr float kAnyTurn = 0.72F;
// Limit of TurnScreen's score for any rotation about an axis that is not refined yet: those found
// have 0.031 and less.
constexpr float kMaxAxisScreen = 0.04F;
// An axis is refined from a few rotations, as long as more of a few samples are kept.
constexpr int kMaxRounds = 4;
constexpr std::size_t kFewTurns = 5, kAxisQueries = 200;
constexpr float kAlongAxis = 0.99F;         // cosine
constexpr std::size_t kFirstQueries = 300;  // samples of the first rating
constexpr std::size_t kLastQueries = 800;   // samples of the last rating

/// The k-th of kNumTurns rotations.
Eigen::Matrix3f spread_turn(int k) {
  const double s = k + 0.5, share = s / kNumTurns, angle = 2 * std::numbers::pi * s;
  const double r = std::sqrt(share), R = std::sqrt(1 - share);
  const double alpha = angle / std::numbers::sqrt2, beta = angle / 1.533751168755204288118041;
  const Eigen::Quaterniond q(R * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha),
                             R * std::sin(beta));
  return q.toRotationMatrix().cast<float>();
}

const std::vector<Eigen::Matrix3f>& spread_turns() {
  static const std::vector<Eigen::Matrix3f> turns = [] {
    std::vector<Eigen::Matrix3f> made;
    for (int k = 0; k < kNumTurns; ++k) made.push_back(spread_turn(k));
    return made;
  }();
  return turns;
}

class NearSearch {
 public:
  NearSearch(const ModelSamples& samples, const SampledSurface& surface, const TurnScreen& screen,
             const Symmetry& symmetry)
      : samples_(samples), surface_(surface), screen_(screen), symmetry_(symmetry) {}

  NearSymmetries run() {
    NearSymmetries found;
    found.axis = near_axis();
    found.motions = motions(found.axis);
    return found;
  }

 private:
  struct Rated {
    float rating;
    Pose motion;
  };

  /// All transforms that are not rotations about `axis`.
  std::vector<Pose> motions(const std::optional<Symmetry::Axis>& axis) {
    std::vector<Rated> alternatives;
    std::vector<Pose> visited;
    for (const Pose& start : starts()) {
      Pose motion = surface_.refine(start, 120, 4);
      const Pose reached = surface_.to_model(motion);
      const auto same = [&](const Pose& other) {
        const PoseDistance d = pose_distance(reached, other, symmetry_, samples_.center);
        return d.rotation_rad < kSameTurn && d.translation < kSameShift * samples_.diameter;
      };
      if (is_identity(reached) || std::ranges::any_of(visited, same) || turns_about(axis, reached))
        continue;
      visited.push_back(reached);
      if (alike(motion, kFirstQueries) < kMinAlike - 0.1F) continue;
      motion = surface_.refine(motion, 200, 3);
      const Pose alternative = surface_.to_model(motion);
      const float rating = alike(motion, kLastQueries);
      if (rating >= kMinAlike && !is_identity(alternative) && is_best_around(motion))
        alternatives.push_back({rating, alternative});
    }
    best_first(alternatives);
    std::vector<Pose> chosen;
    for (float apart = kTurned;; apart *= 1.1F) {
      chosen = choose(alternatives, apart);
      if (chosen.size() <= kMaxFound) return chosen;
    }
  }

  /// The axis whose least similar rotation is the most similar.
  std::optional<Symmetry::Axis> near_axis() {
    if (symmetry_.axis) return {};
    std::array<float, 10> angles;
    for (std::size_t k = 0; k < angles.size(); ++k) {
      angles[k] =
          std::remainder(kGoldenAngle * static_cast<float>(k + 1), 2 * std::numbers::pi_v<float>);
    }
    float best = kAnyTurn;
    std::optional<Symmetry::Axis> found;
    for (const Eigen::Vector3f& direction : likely_axes()) {
      Symmetry::Axis axis{direction, Eigen::Vector3f::Zero()};
      const bool hopeless = std::ranges::any_of(angles, [&](float angle) {
        return screen_.score(turn_about(axis, angle), kMaxAxisScreen) > kMaxAxisScreen;
      });
      if (hopeless) continue;
      float before = 0, now = kBetter;
      for (int round = 0; round < kMaxRounds && now >= before + kBetter; ++round) {
        axis = refine_axis(surface_, axis, std::span(angles).first(kFewTurns));
        before = std::exchange(now, least_kept(axis, angles, kAxisQueries, 0));
      }
      const float worst = least_kept(axis, angles, kLastQueries, best);
      if (worst <= best) continue;
      best = worst;
      found = Symmetry::Axis{axis.direction, surface_.to_model(axis.point)};
    }
    return found;
  }

  /// The share of samples kept by the least similar of some rotations. If it does not exceed a
  /// limit, some value that does not either.
  float least_kept(const Symmetry::Axis& axis, std::span<const float> angles,
                   std::size_t num_queries, float limit) {
    float least = 1;
    for (std::size_t k = 0; k < angles.size() && least > limit; ++k)
      least = std::min(least, kept(turn_about(axis, angles[k]), num_queries));
    return least;
  }

  /// Directions through the centroid.
  std::vector<Eigen::Vector3f> likely_axes() const {
    const Eigen::Matrix3f principal = screen_.principal_axes();
    std::vector<Eigen::Vector3f> directions;
    const auto add = [&](const Eigen::Vector3f& direction) {
      const auto same = [&](const Eigen::Vector3f& other) {
        return std::abs(other.dot(direction)) > kAlongAxis;
      };
      if (std::ranges::none_of(directions, same)) directions.push_back(direction);
    };
    for (const Pose& motion : symmetry_.poses) add(axis_of(motion).direction);
    for (int k = 0; k < 3; ++k) add(principal.col(k));
    return directions;
  }

  static bool turns_about(const std::optional<Symmetry::Axis>& axis, const Pose& motion) {
    return axis && axis->direction.dot(motion.linear() * axis->direction) > kAlongAxis;
  }

  static void best_first(std::vector<Rated>& motions) {
    std::stable_sort(motions.begin(), motions.end(),
                     [](const Rated& a, const Rated& b) { return a.rating > b.rating; });
  }

  /// The rotation angle between two transforms of the model's frame, modulo the symmetry [rad].
  float turn_between(const Pose& a, const Pose& b) const {
    return pose_distance(a, b, symmetry_, samples_.center).rotation_rad;
  }
  bool is_identity(const Pose& motion, float apart = kTurned) const {
    return turn_between(Pose::Identity(), motion) < apart;
  }

  /// The best rotations, apart from each other, with their best-fitting shifts.
  std::vector<Pose> starts() const {
    std::vector<Rated> rated;
    for (const Eigen::Matrix3f& rotation : spread_turns()) {
      Pose turn = Pose::Identity();
      turn.linear() = rotation;
      const float score = screen_.score(turn, kMaxScreen);
      if (score <= kMaxScreen) rated.push_back({-score, turn});
    }
    best_first(rated);
    if (rated.size() > kMaxCompared) rated.resize(kMaxCompared);

    std::vector<Pose> chosen, in_model;
    for (const Rated& candidate : rated) {
      if (chosen.size() == kMaxRefined) break;
      const Pose motion = surface_.to_model(candidate.motion);
      const auto near = [&](const Pose& other) {
        return turn_between(motion, other) < kStartsApart;
      };
      if (is_identity(motion, kStartsApart) || std::ranges::any_of(in_model, near)) continue;
      chosen.push_back(candidate.motion);
      in_model.push_back(motion);
    }
    for (Pose& turn : chosen) turn = shifted(turn);
    return chosen;
  }

  /// Shift along the principal axes, the longest first, to the best score of the screen.
  Pose shifted(Pose motion) const {
    constexpr float kStep = 0.04F;
    const Eigen::Matrix3f axes = screen_.principal_axes();
    float best = screen_.score(motion, 1);
    for (int axis = 2; axis >= 0; --axis) {
      const Pose start = motion;
      for (int k = -7; k <= 7; ++k) {
        Pose moved = start;
        moved.translation() += kStep * static_cast<float>(k) * axes.col(axis);
        const float score = screen_.score(moved, best);
        if (score >= best) continue;
        best = score;
        motion = moved;
      }
    }
    return motion;
  }

  /// The share of samples that a transform in the surface's frame keeps on the surface; matched_
  /// marks them.
  float kept(const Pose& motion, std::size_t num_queries) {
    matched_.resize(std::min(num_queries, surface_.size()));
    surface_.mark_matched(motion, kOnSurface, matched_);
    const auto all = std::accumulate(matched_.begin(), matched_.end(), std::size_t{0});
    return static_cast<float>(all) / static_cast<float>(matched_.size());
  }

  /// The share of samples visible in a view that a transform in the surface's frame keeps on the
  /// surface; for the last of the best quarter of all views. 0 if too few of all samples are kept:
  /// the visible parts of flat objects fit under many transforms.
  float alike(const Pose& motion, std::size_t num_queries) {
    if (kept(motion, num_queries) < kMinShare) return 0;
    std::array<std::uint32_t, kNumViews> visible{}, kept{};
    for (std::size_t i = 0; i < matched_.size(); ++i) {
      for (std::size_t w = 0; w < kViewWords; ++w) {
        for (std::uint64_t bits = samples_.views[i][w]; bits != 0; bits &= bits - 1) {
          const std::size_t view = 64 * w + static_cast<std::size_t>(std::countr_zero(bits));
          ++visible[view];
          kept[view] += matched_[i];
        }
      }
    }
    std::array<float, kNumViews> shares{};
    for (std::size_t v = 0; v < kNumViews; ++v) {
      if (visible[v] > 0) shares[v] = static_cast<float>(kept[v]) / static_cast<float>(visible[v]);
    }
    const auto last = shares.begin() + kViewsAlike - 1;
    std::nth_element(shares.begin(), last, shares.end(), std::greater<>());
    return *last;
  }

  /// Whether no neighboring rotation of a transform in the surface's frame looks more alike. Flat
  /// faces fit under any rotation about their normals, and refinement has no preference among
  /// these.
  bool is_best_around(const Pose& motion) {
    const Eigen::Matrix3f axes = screen_.principal_axes();
    const float limit = alike(motion, kFirstQueries) + kBetter;
    for (int axis = 0; axis < 3; ++axis) {
      for (const float angle : {-kAround, kAround}) {
        const Eigen::Vector3f turn = angle * axes.col(axis);
        const Pose beside =
            small_motion(turn, Eigen::Vector3f::Zero(), motion.translation()) * motion;
        if (alike(beside, kFirstQueries) > limit) return false;
      }
    }
    return true;
  }

  /// The best transforms that are apart from each other, each with its inverse.
  std::vector<Pose> choose(const std::vector<Rated>& alternatives, float apart) const {
    std::vector<Pose> chosen;
    const auto add = [&](const Pose& motion) {
      const auto near = [&](const Pose& other) { return turn_between(motion, other) < apart; };
      if (is_identity(motion, apart) || std::ranges::any_of(chosen, near)) return false;
      chosen.push_back(motion);
      return true;
    };
    for (const Rated& alternative : alternatives) {
      if (add(alternative.motion)) add(alternative.motion.inverse());
    }
    return chosen;
  }

  const ModelSamples& samples_;
  const SampledSurface& surface_;
  const TurnScreen& screen_;
  const Symmetry& symmetry_;
  std::vector<std::uint8_t> matched_;
};

}  // namespace

NearSymmetries find_near_symmetries(const ModelSamples& samples, const SampledSurface& surface,
                                    const TurnScreen& screen, const Symmetry& symmetry) {
  TRIVET_REQUIRE(samples.points.size() == surface.size(), "the surface is that of the samples");
  if (surface.size() < kMinSurface) return {};
  return NearSearch(samples, surface, screen, symmetry).run();
}

}  // namespace trivet::kernels
