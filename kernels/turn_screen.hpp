/// Which turns might map a surface onto itself: a fast look at all axes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kernels/sampled_surface.hpp"

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

 private:
  static constexpr int kSize = 48;      // voxels along a side of the field
  static constexpr float kCap = 0.06F;  // larger distances count as this

  float score(const Eigen::Matrix3f& rotation, float limit) const noexcept;

  PointsView points_;
  std::size_t stride_;
  float scale_;               // voxels per diameter
  std::vector<float> field_;  // distance from the surface at voxel centres
  Eigen::Matrix3f inertia_;   // second moments of the samples
};

}  // namespace trivet::kernels
