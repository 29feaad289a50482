/// Equations of a pose from the distances between its ends and those of the measured surface.
#pragma once

#include "kernels/verification/examine_pose.hpp"
#include "kernels/verification/examined_rays.hpp"

namespace trivet::kernels {

/// Sums over the ends of a model in all images.
class EdgeEquations {
 public:
  /// Add the distance between an end of the model and that of the measured surface before it, if
  /// the surface ends nearby, before something farther.
  void add(const ExaminedRays& rays, const RayEnd& end);
  /// Add these equations to those of the surfaces. Those of a side of the object err alike.
  void add_to(PoseEquations& equations) const;

 private:
  PoseEquations sums_;
  double count_ = 0;
};

}  // namespace trivet::kernels
