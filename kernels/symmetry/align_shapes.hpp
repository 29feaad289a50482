/// Where another shape lies when it looks like this one.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kernels/symmetry/turn_screen.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// How the samples of a surface are spread about their mean.
struct ShapeFrame {
  Eigen::Vector3f center{0, 0, 0};
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();  ///< columns: principal axes, right-handed
  Eigen::Vector3f deviations{0, 0, 0};  ///< standard deviations along them, rising [samples' unit]
};

/// samples  n >= 1, about uniform over the surface. Moves with them.
ShapeFrame shape_frame(PointsView samples);

/// Brings other shapes to lie where one shape lies.
class ShapeAligner {
 public:
  struct Alignment {
    Pose T_this_other;
    float distance;  ///< mean distance of the other's samples from this surface [diameters]
  };
  static constexpr float kMaxDistance = 0.03F;  ///< of what looks alike [diameters]

  /// points    n >= 1 samples of the surface, in random order [m]
  /// normals   n unit vectors; samples whose normal is NaN are left out
  /// frame     of the samples
  /// diameter  > 0 [m]
  ShapeAligner(PointsView points, NormalsView normals, const ShapeFrame& frame, float diameter);

  /// Up to two rotations under which the other shape comes nearest, the second one only if it is
  /// nearly as near; none if it comes nowhere within kMaxDistance. Centers are laid on one another.
  ///
  /// points  samples of the other surface, in random order
  /// Principal axes are laid on those of like deviations, either way round; about an axis across
  /// which the shape is spread evenly, as that of a nut, turns by 15 degrees are tried: a search
  /// that refines poses reaches what lies between.
  std::vector<Alignment> align(PointsView points, const ShapeFrame& frame) const;

 private:
  /// Those of the other shape's principal frame into that of this one.
  std::vector<Eigen::Matrix3f> likely_rotations(const ShapeFrame& other) const;

  ShapeFrame frame_;
  float diameter_;
  SampledSurface surface_;
  TurnScreen screen_;
};

}  // namespace trivet::kernels
