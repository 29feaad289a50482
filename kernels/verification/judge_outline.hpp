/// Judgment of the scene beyond the ends of a posed model.
#pragma once

#include "kernels/verification/edge_equations.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "kernels/verification/examined_rays.hpp"

namespace trivet::kernels {

/// Sums over the outlines of all images.
struct OutlineSums {
  double count = 0;                      ///< number of outline positions
  Matrix6 covariance = Matrix6::Zero();  ///< sum of J J^T where the outline holds the pose
};

/// Beyond the outline, the scene of a real object falls back or is not measured, within the few
/// pixels over which sensors blur edges; for a wrong fit on a larger surface that surface
/// continues.
///
/// out    receives the counts of the outline and of buried edges
/// edges  receives the distances of the ends from edges of the scan; null: not wanted
void judge_outline(const ExaminedRays& rays, Examination& out, OutlineSums& sums,
                   EdgeEquations* edges);

}  // namespace trivet::kernels
