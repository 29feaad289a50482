#include "kernels/symmetry/find_symmetry.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "kernels/symmetry/angles.hpp"
#include "kernels/symmetry/turn_axis.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kMinSamples = 200;
constexpr int kMaxOrder = 64;  // finer teeth are a continuous axis within the tolerance
constexpr std::size_t kMaxGroup = 128;
constexpr std::size_t kRefineQueries = 200;
constexpr std::size_t kQuickQueries = 500;
constexpr int kMaxFailures = 6;  // then the shape is almost round, and no rotation stands out
constexpr float kContrast = 8;   // ratio of the misfit of the worst rotation about an axis to that
                                 // of a symmetry: on a shape that is almost round, all rotations
                                 // almost fit
constexpr float kSameRotation = 0.05F;  // [rad]; half the step of the finest group
constexpr float kSameAxis = 0.09F;      // [rad]

using Axis = Symmetry::Axis;

/// The rotation angle between two transforms [rad], accurate for small angles: up to half a turn,
/// |A - B| = 2 sqrt(2) sin(angle / 2).
float turn_between(const Pose& a, const Pose& b) {
  return (a.linear() - b.linear()).norm() / 1.4142136F;
}

class Search {
 public:
  Search(const SampledSurface& surface, const TurnScreen& screen, float tolerance)
      : surface_(surface), screen_(screen), tolerance_(tolerance) {}

  Symmetry run() {
    if (surface_.size() < kMinSamples) return {};
    int failures = 0;
    for (const TurnScreen::Candidate& candidate : screen_.candidates()) {
      if (failures == kMaxFailures) break;
      const std::optional<Axis> axis = verify(candidate);
      if (!axis) continue;
      const float worst = worst_turn(*axis);
      if (const auto free = worst <= 2 ? refine_free_axis(*axis) : std::nullopt) {
        return with_axis(*free);
      }
      if (!extend(*axis, candidate.order, std::min(1.0F, worst / kContrast))) ++failures;
    }
    Symmetry result;
    for (const Pose& motion : group_) result.poses.push_back(surface_.to_model(motion));
    return result;
  }

 private:
  /// Whether a transform is a symmetry, on all samples.
  bool holds(const Pose& motion, float limit = 1) const {
    return surface_.misfit(motion, tolerance_, limit, surface_.size()) <= limit;
  }
  /// Whether it may be a symmetry, on fewer samples, whose shares are less certain.
  bool may_hold(const Pose& motion, float limit = 1) const {
    return surface_.misfit(motion, tolerance_, 2 * limit, kQuickQueries) <= 2 * limit;
  }

  bool known(const Pose& motion, float angle = kSameRotation) const {
    const auto same = [&](const Pose& other) { return turn_between(motion, other) < angle; };
    return same(Pose::Identity()) || std::any_of(group_.begin(), group_.end(), same);
  }

  /// The axis of a candidate after refinement, if its rotation is a symmetry that is not known yet.
  std::optional<Axis> verify(const TurnScreen::Candidate& candidate) const {
    const float angle = 2 * std::numbers::pi_v<float> / static_cast<float>(candidate.order);
    const Pose start = turn_about({candidate.direction, Vector3f::Zero()}, angle);
    if (known(start, kSameAxis)) return {};

    const Pose refined = surface_.refine(start, kRefineQueries, 4);
    if (turn_between(start, refined) > std::min(0.15F, angle / 4)) return {};
    const Axis axis = axis_of(refined);
    if (!may_hold(turn_about(axis, angle))) return {};
    return axis;
  }

  /// The misfit of the worst of several rotations by angles of no regular polygon; kContrast or a
  /// little more if it is larger.
  float worst_turn(const Axis& axis) const {
    float worst = 0;
    for (int k = 1; k <= 8 && worst < kContrast; ++k) {
      const Pose motion = turn_about(axis, kGoldenAngle * static_cast<float>(k));
      worst = std::max(worst, surface_.misfit(motion, tolerance_, kContrast, kQuickQueries));
    }
    return worst;
  }

  /// The axis refined from several rotations, if all those are symmetries.
  std::optional<Axis> refine_free_axis(const Axis& axis) const {
    constexpr int kNumTried = 4;
    std::array<float, kNumTried> angles;
    for (int k = 0; k < kNumTried; ++k) {
      angles[static_cast<std::size_t>(k)] =
          std::remainder(kGoldenAngle * static_cast<float>(k + 1), 2 * std::numbers::pi_v<float>);
    }
    const Axis better = refine_axis(surface_, axis, angles);
    for (const float angle : angles) {
      if (!holds(turn_about(better, angle))) return {};
    }
    return better;
  }

  /// The symmetry of a surface with a free axis: its ends, or all directions, may be equivalent.
  Symmetry with_axis(const Axis& axis) const {
    Symmetry result;
    result.axis = Symmetry::Axis{axis.direction, surface_.to_model(axis.point)};
    const Vector3f across = axis.direction.unitOrthogonal();
    const Pose flip = flip_about(axis, across);
    if (!holds(flip)) return result;
    if (!is_sphere(axis, across)) {
      result.poses.push_back(surface_.to_model(flip));
      return result;
    }

    // Rotate the axis to the points of a Fibonacci sphere.
    constexpr int kNumDirections = 128;
    for (int k = 0; k < kNumDirections; ++k) {
      const float z = 1 - (2 * static_cast<float>(k) + 1) / kNumDirections;
      const float r = std::sqrt(1 - z * z), angle = kGoldenAngle * static_cast<float>(k);
      Pose tilt = Pose::Identity();
      tilt.linear() = Eigen::Quaternionf::FromTwoVectors(
                          axis.direction, Vector3f(r * std::cos(angle), r * std::sin(angle), z))
                          .toRotationMatrix();
      tilt.translation() = axis.point - tilt.linear() * axis.point;
      result.poses.push_back(surface_.to_model(tilt));
    }
    return result;
  }

  /// A half turn about a line perpendicular to the axis, at the best-fitting height along it.
  Pose flip_about(const Axis& axis, const Vector3f& across) const {
    const Pose refined = surface_.refine(
        turn_about({across, axis.point}, std::numbers::pi_v<float>), kRefineQueries, 5);
    const float along = 0.5F * axis.direction.dot(refined * axis.point - axis.point);
    return turn_about({across, axis.point + along * axis.direction}, std::numbers::pi_v<float>);
  }

  bool is_sphere(const Axis& axis, const Vector3f& across) const {
    for (int k = 1; k <= 8; ++k) {
      const Vector3f direction =
          Eigen::AngleAxisf(kGoldenAngle * static_cast<float>(k), axis.direction) * across;
      if (!holds(turn_about({direction, axis.point}, static_cast<float>(k)))) return false;
    }
    return true;
  }

  /// Whether all powers of a rotation of some order may be symmetries: a small rotation alone
  /// always is.
  bool powers_may_hold(const Axis& axis, int order, float limit) const {
    for (int k = 1; k <= order / 2; ++k) {
      if (!may_hold(turn_about(axis, 2 * std::numbers::pi_v<float> * static_cast<float>(k) /
                                         static_cast<float>(order)),
                    limit)) {
        return false;
      }
    }
    return true;
  }

  /// Add the rotations of the largest order of the axis, and their products with the group. False
  /// if they were approximate symmetries, but are none.
  bool extend(const Axis& axis, int order, float limit) {
    if (!powers_may_hold(axis, order, limit)) return true;
    int largest = order;
    for (const int prime : {2, 2, 2, 2, 2, 3, 3, 3, 5, 5, 7, 11, 13, 17, 19, 23, 29, 31}) {
      const int next = largest * prime;
      if (next <= kMaxOrder && powers_may_hold(axis, next, limit)) largest = next;
    }
    return add_turns(axis, largest, limit) || (largest != order && add_turns(axis, order, limit));
  }

  /// Refine an axis and add its rotations and their products with the group. Adds nothing and
  /// returns false if they are not symmetries.
  bool add_turns(const Axis& axis, int order, float limit) {
    const auto angle = [order](int k) {
      return 2 * std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(order);
    };
    std::vector<float> angles;
    for (int k = 1; k <= std::min(order / 2, 6); ++k) angles.push_back(angle(k));
    const Axis better = refine_axis(surface_, axis, angles);

    const std::vector<Pose> before = group_;
    bool good = true;
    for (int k = 1; k < order && good; ++k) {
      const Pose power = turn_about(better, angle(k));
      if (known(power)) continue;
      // Rotations by k and order - k are inverse to each other: only one of them is tested.
      good = k > order / 2 || holds(power, limit);
      group_.push_back(power);
    }
    good = good && close_group();
    if (!good) group_ = before;
    return good;
  }

  /// Close the group under composition. False if a product is not a symmetry or the group does not
  /// end: then one of the factors is not a symmetry either.
  bool close_group() {
    for (std::size_t i = 0; i < group_.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        for (const Pose& product : {Pose(group_[i] * group_[j]), Pose(group_[j] * group_[i])}) {
          if (known(product)) continue;
          const Pose refined = surface_.refine(product, kRefineQueries, 2);
          if (group_.size() == kMaxGroup || !may_hold(refined)) return false;
          if (!known(refined)) group_.push_back(refined);
        }
      }
    }
    return true;
  }

  const SampledSurface& surface_;
  const TurnScreen& screen_;
  float tolerance_;
  std::vector<Pose> group_;  // without the identity
};

}  // namespace

Symmetry find_symmetry(const SampledSurface& surface, const TurnScreen& screen, float tolerance) {
  return Search(surface, screen, tolerance).run();
}

}  // namespace trivet::kernels
