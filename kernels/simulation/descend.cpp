#include "kernels/simulation/descend.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;

constexpr int kMaxSweeps = 300;
constexpr double kConverged = 1e-5;  // relative to `fall`

/// One direction at a contact. The body rotates in units of its radius of gyration: its mass is 1
/// for shifts and rotations alike.
struct Row {
  Vector3d shift, turn;
  double inverse_mass;
  Row(const Vector3d& direction, const Vector3d& arm)
      : shift(direction),
        turn(arm.cross(direction)),
        inverse_mass(direction.squaredNorm() + turn.squaredNorm()) {}
};

struct Held {
  Row normal, first, second;
  double gap;
  double push = 0, rub_first = 0, rub_second = 0;  // impulses
};

struct Velocity {
  Vector3d shift, turn;
  double along(const Row& row) const { return shift.dot(row.shift) + turn.dot(row.turn); }
  void add(const Row& row, double impulse) {
    shift += impulse * row.shift;
    turn += impulse * row.turn;
  }
};

/// Solve one contact for its normal and friction impulses. Returns the largest change of an
/// impulse.
double relax(Held& held, double friction, Velocity& velocity) {
  const double push = std::max(
      0.0, held.push - (velocity.along(held.normal) + held.gap) / held.normal.inverse_mass);
  double change = std::abs(push - held.push);
  velocity.add(held.normal, push - held.push);
  held.push = push;

  double first = held.rub_first - velocity.along(held.first) / held.first.inverse_mass,
         second = held.rub_second - velocity.along(held.second) / held.second.inverse_mass;
  const double size = std::sqrt(first * first + second * second), most = friction * held.push;
  const double share = size > most ? most / size : 1;
  first *= share;
  second *= share;
  change = std::max({change, std::abs(first - held.rub_first), std::abs(second - held.rub_second)});
  velocity.add(held.first, first - held.rub_first);
  velocity.add(held.second, second - held.rub_second);
  held.rub_first = first;
  held.rub_second = second;
  return change;
}

}  // namespace

Motion descend(std::span<const Contact> contacts, const Vector3d& center, double gyration,
               double fall, double friction) {
  TRIVET_REQUIRE(gyration > 0 && fall > 0, "a body of some extent that wants to fall");
  std::vector<Held> held;
  held.reserve(contacts.size());
  for (const Contact& contact : contacts) {
    const Vector3d arm = (contact.point - center) / gyration, n = contact.normal,
                   first = n.unitOrthogonal();
    held.push_back({Row(n, arm), Row(first, arm), Row(n.cross(first), arm), contact.gap});
  }
  Velocity velocity{{0, 0, -fall}, {0, 0, 0}};
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double change = 0;
    for (Held& contact : held) change = std::max(change, relax(contact, friction, velocity));
    if (change < kConverged * fall) break;
  }
  return {velocity.shift, velocity.turn / gyration};
}

}  // namespace trivet::kernels
