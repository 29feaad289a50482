/// Fast screening of all axes for rotations that may map a surface onto itself.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kernels/symmetry/sampled_surface.hpp"

namespace trivet::kernels {

/// Rates rotations about axes through the centroid on a coarse field of distances from the surface.
class TurnScreen {
 public:
  struct Candidate {
    Eigen::Vector3f direction;  ///< unit vector
    int order;                  ///< prime; the rotation angle is 2 pi / order
    float score;                ///< mean distance of the rotated samples [diameters], capped
  };

  explicit TurnScreen(const SampledSurface& surface);

  /// Rotations that may be symmetries, higher orders first, then by ascending score.
  std::vector<Candidate> candidates() const;

  /// Mean distance of transformed samples from the surface [diameters], each capped at 0.06. Stops
  /// early if it exceeds `limit`, and returns some larger number. The transform is in the surface's
  /// normalized frame.
  float score(const Pose& motion, float limit) const noexcept;
  /// As above, for other points in the surface's normalized frame [diameters].
  float score(PointsView points, const Pose& motion, float limit) const noexcept;
  /// Columns: the principal axes of inertia, the longest extent last.
  Eigen::Matrix3f principal_axes() const;

 private:
  static constexpr int kSize = 48;      // voxels along a side of the field
  static constexpr float kCap = 0.06F;  // cap of distances

  PointsView points_;
  Points scored_;             // a subset, spread over all samples
  float scale_;               // voxels per diameter
  std::vector<float> field_;  // distance from the surface at voxel centers
  Eigen::Matrix3f inertia_;   // second moments of the samples
};

}  // namespace trivet::kernels
