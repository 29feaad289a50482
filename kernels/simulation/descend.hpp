/// One small motion of a body under gravity.
#pragma once

#include <Eigen/Core>
#include <span>

#include "kernels/simulation/pile.hpp"

namespace trivet::kernels {

/// Rotation by |turn| about `turn`, then translation, both about the body's center of mass.
struct Motion {
  Eigen::Vector3d shift{0, 0, 0};  ///< [m]
  Eigen::Vector3d turn{0, 0, 0};   ///< [rad]
};

/// Find the motion of a body that would fall by `fall` if it were free.
///
/// contacts  contacts that support it; gaps >= 0 are closed at most
/// center    center of mass [m]
/// gyration  radius of gyration > 0 [m], the same about every axis
/// fall      > 0 [m]
/// friction  Coulomb coefficient, >= 0: a contact does not slip below that share of its force
/// Returns the motion; almost zero if the body is at rest. Quasi-static: no momentum.
/// Source: Gauss's principle of least constraint for one step of unilateral contacts, solved by
/// projected Gauss-Seidel (Moreau, "Unilateral contact and dry friction in finite freedom
/// dynamics", 1988; Jourdan, Alart, Jean, CMAME 1998).
Motion descend(std::span<const Contact> contacts, const Eigen::Vector3d& center, double gyration,
               double fall, double friction);

}  // namespace trivet::kernels
