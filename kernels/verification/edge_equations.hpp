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
  /// Add these equations to those of the surfaces, without the shifts that all edges of a kind
  /// share: sensors lose pixels at edges, or let objects grow there, alike on all sides. Those of a
  /// side of the object err alike besides.
  void add_to(PoseEquations& equations) const;

 private:
  /// A shift of edges away from the model [pixel]: its own equation, and its terms in the others.
  struct SharedShift {
    Eigen::Matrix<double, 6, 1> cross = Eigen::Matrix<double, 6, 1>::Zero();
    double information = 0, gradient = 0;
  };

  PoseEquations sums_;
  SharedShift of_steps_, of_gaps_;  // of edges whose pixels sensors measure, and lose
  double shift_deviation_ = 0;      // by the sensor [pixel]
  double count_ = 0;
};

}  // namespace trivet::kernels
