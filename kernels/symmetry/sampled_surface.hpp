/// A sampled surface, and the test whether a transform maps it onto itself.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "kernels/common/voxel_hash.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Samples in a normalized frame: the centroid is the origin, the diameter is 1.
///
/// Distance of a transformed sample q with normal m from the surface: over the samples p with
/// normal n within 30 degrees of m, the least of sqrt(h^2 + max(0, l - slack)^2). h is the part of
/// q - p along n + m: it is zero for two points of one circle, so that curved surfaces cost no
/// accuracy (Rusinkiewicz, "A symmetric objective function for ICP", 2019). l is the rest, the
/// distance along the surface. slack is twice the mean distance of neighboring samples, and more
/// for a sample on a face so narrow that its neighbors there are farther, so that gaps between
/// samples do not count as distance. Without any such p the distance is kCap.
///
/// The error due to sampling depends on the shape. It is measured, not guessed: the distances of
/// each sample from all the others are those that a true symmetry would show.
class SampledSurface {
 public:
  static constexpr float kCap = 0.04F;         ///< cap of distances
  static constexpr float kMaxSlack = 0.1F;     ///< cap of slack: no sample represents more of the
                                               ///< surface
  static constexpr float kMinCosine = 0.866F;  ///< limit for corresponding normals: 30 degrees

  /// points    n >= 1 positions [m]
  /// normals   n unit vectors; samples with a NaN normal are omitted
  /// diameter  > 0 [m]
  SampledSurface(PointsView points, NormalsView normals, float diameter);

  std::size_t size() const noexcept { return points_.size(); }
  PointsView points() const noexcept { return points_; }
  NormalsView normals() const noexcept { return normals_; }
  float slack() const noexcept { return slack_; }

  /// Misfit of a transform (in this frame) that should map the surface onto itself, beyond the
  /// sampling error; up to 1 is a symmetry. The largest of: mean square distance over tolerance^2;
  /// the share of samples farther than three tolerances, over 2 %; the share farther than six, over
  /// 0.25 %. The last preserves small features that a pose must respect: a handle, a key, a notch.
  /// Uses num_queries samples, spread over the surface. Stops early if the misfit exceeds
  /// `give_up`, and returns some larger number.
  float misfit(const Pose& motion, float tolerance, float give_up,
               std::size_t num_queries) const noexcept;

  /// Mark the first samples that a transform (in this frame) brings within `distance` < kCap of the
  /// surface with agreeing normals: 1 or 0 for each. Pre: out.size() <= size().
  void mark_matched(const Pose& motion, float distance, std::span<std::uint8_t> out) const noexcept;

  /// Refine a transform that almost maps the surface onto itself, by point-to-plane steps on
  /// num_queries samples, damped so that motion along the surface is not changed.
  Pose refine(Pose motion, std::size_t num_queries, int num_steps) const noexcept;

  /// The transform in the frame and unit of the original samples.
  Pose to_model(const Pose& motion) const noexcept;
  Eigen::Vector3f to_model(const Eigen::Vector3f& point) const noexcept {
    return center_ + diameter_ * point;
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFF'FFFFU;
  struct Match {
    float distance = kCap;
    std::uint32_t index = kNone;
  };
  /// No match if nothing is nearer than `cap`, not counting the sample at a given grid position.
  Match match(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float slack,
              std::uint32_t excluded, float cap = kCap) const noexcept;
  /// Call visit(samples, runs) with runs that include all samples within a radius, which is kCap +
  /// kMaxSlack at most.
  template <class Visit>
  void visit_runs(const Eigen::Vector3f& point, float radius, Visit&& visit) const noexcept;

  Eigen::Vector3f center_{0, 0, 0};
  float diameter_ = 1;
  float slack_ = 0;       // slack of most samples
  Column<float> slacks_;  // slack of each sample
  Points points_;
  Normals normals_;
  VoxelHash grid_;
  // In the grid's order, followed by padding that fills a vector's lanes and matches nothing.
  Points sorted_points_;
  Normals sorted_normals_;
  Column<float> own_distances_;  // distance of each sample from all others
};

}  // namespace trivet::kernels
