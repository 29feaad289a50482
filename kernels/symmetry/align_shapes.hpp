/// Alignment of similar shapes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kernels/symmetry/turn_screen.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Principal axes and spread of the samples of a surface about their mean.
struct ShapeFrame {
  Eigen::Vector3f center{0, 0, 0};
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();  ///< columns: principal axes, right-handed
  Eigen::Vector3f deviations{0, 0, 0};  ///< standard deviations along the axes, ascending [samples'
                                        ///< unit]
};

/// samples  n >= 1, roughly uniform over the surface. The frame moves with them.
ShapeFrame shape_frame(PointsView samples);

/// Aligns other shapes with one shape.
class ShapeAligner {
 public:
  struct Alignment {
    Pose T_this_other;
    float distance;  ///< mean distance of the other shape's samples from this surface [diameters]
  };
  static constexpr float kMaxDistance = 0.03F;  ///< largest distance of similar shapes [diameters]

  /// points    n >= 1 samples of the surface, in random order [m]
  /// normals   n unit vectors; samples with a NaN normal are omitted
  /// frame     shape frame of the samples
  /// diameter  > 0 [m]
  ShapeAligner(PointsView points, NormalsView normals, const ShapeFrame& frame, float diameter);

  /// Up to four rotations that bring the other shape nearest, the further ones only if they are nearly
  /// as near, as half turns of a block with one hole are; none if no rotation is within kMaxDistance. The centers coincide.
  ///
  /// points  samples of the other surface, in random order
  /// Principal axes are aligned with those of similar deviations, in both directions. About an axis
  /// across which the shape is spread evenly, as that of a nut, rotations by steps of 15 degrees
  /// are tried: a search that refines poses reaches those between.
  std::vector<Alignment> align(PointsView points, const ShapeFrame& frame) const;

 private:
  /// Candidate rotations from the other shape's principal frame to that of this one.
  std::vector<Eigen::Matrix3f> likely_rotations(const ShapeFrame& other) const;

  ShapeFrame frame_;
  float diameter_;
  SampledSurface surface_;
  TurnScreen screen_;
};

}  // namespace trivet::kernels
