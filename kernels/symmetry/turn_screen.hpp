/// Which turns might map a surface onto itself: a fast look at all axes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kernels/symmetry/sampled_surface.hpp"

namespace trivet::kernels {

/// Rates turns about axes through the centroid on a coarse field of distances from the surface.
class TurnScreen {
 public:
  struct Candidate {
    Eigen::Vector3f direction;  ///< unit
    int order;                  ///< prime; the turn is by 2 pi / order
    float score;                ///< mean distance of the turned samples [diameters], capped
  };

  explicit TurnScreen(const SampledSurface& surface);

  /// Turns that may be symmetries, higher orders first, then by rising score.
  std::vector<Candidate> candidates() const;

  /// Mean distance of moved samples from the surface [diameters], each capped at 0.06; where it
  /// exceeds `limit`, some number above that, found early. The motion is one of the surface's own
  /// frame.
  float score(const Pose& motion, float limit) const noexcept;
  /// The same of other points, in the surface's own frame [diameters].
  float score(PointsView points, const Pose& motion, float limit) const noexcept;
  /// Columns: the principal axes of inertia, the longest extent last.
  Eigen::Matrix3f principal_axes() const;

 private:
  static constexpr int kSize = 48;      // voxels along a side of the field
  static constexpr float kCap = 0.06F;  // larger distances count as this

  PointsView points_;
  Points scored_;             // some of them, spread over all
  float scale_;               // voxels per diameter
  std::vector<float> field_;  // distance from the surface at voxel centers
  Eigen::Matrix3f inertia_;   // second moments of the samples
};

}  // namespace trivet::kernels
