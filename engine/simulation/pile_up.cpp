#include "engine/simulation/pile_up.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/common/counter_random.hpp"
#include "kernels/simulation/descend.hpp"
#include "kernels/simulation/pile.hpp"
#include "kernels/surfaces/diameter.hpp"
#include "storage/common/precondition.hpp"

namespace trivet::engine {
namespace {

using Eigen::Vector3d;
using kernels::Contact;
using kernels::CounterRandom;
using kernels::Motion;
using kernels::Pile;

constexpr int kThrows = 6;           // throws per body; the lowest result is used
constexpr int kShakes = 2;           // attempts to lower a resting body
constexpr int kMaxSteps = 120;       // maximum landings until a body rests
constexpr int kDodges = 8;           // directions of sidesteps
constexpr double kFriction = 0.4;    // friction between plastic and steel
constexpr double kPileRadius = 0.3;  // relative to the root of the sum of squared diameters
constexpr double kBinHalf = 0.28;    // relative to the same length
constexpr double kBinAspect = 1.12;  // square root of the ratio of length to width
constexpr double kCell = 1.0 / 96;   // relative to the largest diameter
// In diameters:
constexpr double kFirstFall = 0.05, kLongestFall = 0.4, kLeastFall = 2e-5;
constexpr double kFarthestStep = 0.1, kReach = 0.01;
constexpr double kLeastGain = 1e-7;  // minimum drop in height per step
constexpr double kShakeGain = 2e-3;  // minimum drop in height per shake
constexpr double kAtRest = 2e-3;     // relative to `fall`; less hardly counts as motion

/// A uniform random rotation. Source: Shoemake, Graphics Gems III, 1992.
Eigen::Quaterniond random_rotation(CounterRandom& random) {
  const double u = random.uniform();
  const double a = random.uniform(0, 2 * std::numbers::pi),
               b = random.uniform(0, 2 * std::numbers::pi);
  const double r = std::sqrt(1 - u), s = std::sqrt(u);
  return {s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b)};
}

/// One body until it rests.
class DroppedBody {
 public:
  DroppedBody(const Pile& pile, const Body& body, double limit)
      : pile_(pile), body_(body), limit_(limit), vertices_(body.vertices.size()) {}

  struct State {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Vector3d center{0, 0, 0};  // center of mass in the world
    std::vector<Contact> contacts;
  };

  Pose pose(const State& state) const {
    Pose out = Pose::Identity();
    out.linear() = state.rotation.toRotationMatrix().cast<float>();
    out.translation() =
        (state.center - out.linear().cast<double>() * body_.center.cast<double>()).cast<float>();
    return out;
  }

  /// Lower or raise a state to where it touches.
  void land(State& state, double reach) {
    const Pose from = pose(state);
    for (std::size_t i = 0; i < vertices_.size(); ++i) vertices_.set(i, from * body_.vertices[i]);
    state.center += pile_.land(vertices_, *body_.triangles, reach, scratch_, state.contacts);
  }

  /// Move a landed state along gravity, with friction, until it rests.
  void settle(State& state) {
    const auto diameter = static_cast<double>(body_.diameter);
    double fall = kFirstFall * diameter;
    double reach = -1;  // reach of the state's contacts: unknown
    State next;
    for (int steps = 0; steps < kMaxSteps && fall > kLeastFall * diameter; ++steps) {
      const double wanted = std::min(2 * fall, kReach * diameter);
      if (reach < wanted) {
        land(state, wanted);
        reach = wanted;
      }
      Motion motion =
          kernels::descend(state.contacts, state.center, body_.gyration, fall, kFriction);
      double length = motion.shift.norm() + body_.gyration * motion.turn.norm();
      if (length < kAtRest * fall) {
        if (fall >= kLongestFall * diameter) return;
        fall = std::min(8 * fall, kLongestFall * diameter);
        continue;
      }
      const double share = std::min(1.0, kFarthestStep * diameter / length);
      motion.shift *= share;
      motion.turn *= share;
      length *= share;
      next = moved(state, motion);
      land(next, wanted);
      const double highest = state.center.z() - kLeastGain * diameter;
      bool lower = within(next) && next.center.z() < highest;
      if (!lower && next.center.z() > state.center.z() + length) {
        steps += kDodges;
        lower = dodge(state, motion, length, highest, wanted, next);
      }
      if (lower) {
        std::swap(state, next);
        reach = wanted;
        fall = std::min(2 * fall, kLongestFall * diameter);
      } else {
        fall = share * fall / 4;
      }
    }
  }

  /// Try whether a nudge lets a resting state come to rest lower.
  void shake(State& state, CounterRandom& random) {
    const double angle = random.uniform(0, 2 * std::numbers::pi), size = random.uniform(0.1, 0.4);
    Motion nudge;
    nudge.turn = size * Vector3d(std::cos(angle), std::sin(angle), 0);
    nudge.shift =
        0.05 * static_cast<double>(body_.diameter) * Vector3d(random.normal(), random.normal(), 0);
    State next = moved(state, nudge);
    land(next, 0);
    settle(next);
    if (within(next) &&
        next.center.z() < state.center.z() - kShakeGain * static_cast<double>(body_.diameter)) {
      std::swap(state, next);
    }
  }

 private:
  /// A motion that ends on top of an obstacle has hit the obstacle's side. Repeat it with a
  /// sidestep of a given length, in the direction that lowers the body most. Returns whether the
  /// result is below `highest`.
  bool dodge(const State& state, const Motion& motion, double length, double highest, double reach,
             State& next) {
    bool lower = false;
    for (int i = 0; i < kDodges; ++i) {
      const double angle = 2 * std::numbers::pi * i / kDodges;
      State other = moved(
          state,
          {motion.shift + length * Vector3d(std::cos(angle), std::sin(angle), 0), motion.turn});
      land(other, reach);
      if (!within(other) || other.center.z() >= highest) continue;
      highest = other.center.z();
      std::swap(next, other);
      lower = true;
    }
    return lower;
  }

  bool within(const State& state) const {
    return state.center.head<2>().cwiseAbs().maxCoeff() < limit_;
  }

  static State moved(const State& state, const Motion& motion) {
    State out;
    out.center = state.center + motion.shift;
    const double angle = motion.turn.norm();
    out.rotation = state.rotation;
    if (angle > 0) {
      out.rotation =
          Eigen::Quaterniond(Eigen::AngleAxisd(angle, motion.turn.normalized())) * state.rotation;
      out.rotation.normalize();
    }
    return out;
  }

  const Pile& pile_;
  const Body& body_;
  double limit_;
  Points vertices_;
  Pile::Scratch scratch_;
};

/// Root of the sum of the squared diameters.
double size_of(std::span<const Body> bodies, std::span<const std::uint32_t> order) {
  double sum = 0;
  for (const std::uint32_t i : order) {
    sum += static_cast<double>(bodies[i].diameter) * static_cast<double>(bodies[i].diameter);
  }
  return std::sqrt(sum);
}

double largest_of(std::span<const Body> bodies, std::span<const std::uint32_t> order) {
  float largest = 0;
  for (const std::uint32_t i : order) largest = std::max(largest, bodies[i].diameter);
  return static_cast<double>(largest);
}

}  // namespace

Body make_body(PointsView vertices, const Triangles& triangles) {
  TRIVET_REQUIRE(!vertices.empty() && !triangles.empty(), "a surface");
  const Vector3d origin = vertices[0].cast<double>();
  double area = 0, volume = 0;
  Vector3d area_moment(0, 0, 0), volume_moment(0, 0, 0), open(0, 0, 0);
  double area_square = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vector3d a = vertices[triangles.a[t]].cast<double>() - origin,
                   b = vertices[triangles.b[t]].cast<double>() - origin,
                   c = vertices[triangles.c[t]].cast<double>() - origin;
    const Vector3d cross = (b - a).cross(c - a) / 2, middle = (a + b + c) / 3;
    const double part = a.dot(b.cross(c)) / 6;
    area += cross.norm();
    area_moment += cross.norm() * middle;
    area_square += cross.norm() * middle.squaredNorm();
    open += cross;
    volume += part;
    volume_moment += part * (a + b + c) / 4;
  }
  Body body{vertices, &triangles, kernels::find_diameter(vertices), {0, 0, 0}, 0};
  const auto diameter = static_cast<double>(body.diameter);
  Vector3d center = area > 0 ? Vector3d(area_moment / area) : Vector3d(0, 0, 0);
  body.gyration =
      area > 0 ? std::sqrt(std::max(0.0, area_square / area - center.squaredNorm())) : 0;
  body.gyration = std::max(body.gyration, 0.05 * diameter);
  // For a closed surface with consistent winding; otherwise the sums are meaningless.
  const bool bounds_volume = open.norm() < 1e-3 * area && std::abs(volume) > 1e-3 * area * diameter;
  if (bounds_volume && (volume_moment / volume - center).norm() < 0.3 * diameter) {
    center = volume_moment / volume;
  }
  body.center = (origin + center).cast<float>();
  return body;
}

BinSize choose_bin(std::span<const Body> bodies, std::span<const std::uint32_t> order) {
  const double half =
      std::max(0.75 * kBinAspect * largest_of(bodies, order), kBinHalf * size_of(bodies, order));
  return {kBinAspect * half, half / kBinAspect};
}

std::vector<PlacedBody> pile_up(std::span<const Body> bodies, std::span<const std::uint32_t> order,
                                const BinSize& bin, std::uint64_t seed, std::uint64_t stream) {
  if (order.empty()) return {};
  CounterRandom random(seed, stream, 0);
  const double largest = largest_of(bodies, order), radius = kPileRadius * size_of(bodies, order);
  const double limit = std::min(radius + 2 * largest, bin.maxCoeff() + largest);
  Pile pile(limit + largest, kCell * largest, bin);

  std::vector<PlacedBody> placed;
  for (const std::uint32_t index : order) {
    const Body& body = bodies[index];
    DroppedBody dropped(pile, body, limit);
    DroppedBody::State best;
    for (int i = 0; i < kThrows; ++i) {
      DroppedBody::State state;
      state.rotation = random_rotation(random);
      const double r = radius * std::sqrt(random.uniform()),
                   a = random.uniform(0, 2 * std::numbers::pi);
      state.center = {r * std::cos(a), r * std::sin(a), 0};
      for (int k = 0; k < 2; ++k) {
        if (std::isfinite(bin[k])) state.center[k] = random.uniform(-bin[k], bin[k]);
      }
      dropped.land(state, 0);
      if (i == 0 || state.center.z() < best.center.z()) std::swap(best, state);
    }
    dropped.settle(best);
    for (int i = 0; i < kShakes; ++i) dropped.shake(best, random);
    dropped.land(best, 0);  // at the pose's float precision
    placed.push_back({index, dropped.pose(best)});
    Points world(body.vertices.size());
    for (std::size_t i = 0; i < world.size(); ++i) {
      world.set(i, placed.back().T_world_body * body.vertices[i]);
    }
    pile.add(world, *body.triangles);
  }
  return placed;
}

}  // namespace trivet::engine
