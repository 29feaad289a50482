/// A surface known by samples, and the question whether a motion maps it onto itself.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "kernels/common/voxel_hash.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Samples in a frame of their own: the centroid is the origin, the diameter is 1.
///
/// How far a moved sample q with normal m is from the surface: over the samples p with normal n
/// within 30 degrees of m, the least of sqrt(h^2 + max(0, l - slack)^2). h is the part of q - p
/// along n + m: that is zero for two points of one circle, so that curved surfaces cost no accuracy
/// (Rusinkiewicz, "A symmetric objective function for ICP", 2019). l is the rest, the way along the
/// surface, and slack is twice the mean distance of neighboring samples, more where a sample lies
/// on a face so narrow that its neighbors there are farther: gaps between samples are no distance.
/// Where there is no such p the distance is kCap.
///
/// Sampling leaves an error that depends on the shape. It is measured, not guessed: the distances
/// of each sample from all the others are what a true symmetry would show.
class SampledSurface {
 public:
  static constexpr float kCap = 0.04F;         ///< larger distances count as this
  static constexpr float kMaxSlack = 0.1F;     ///< no sample stands for more of the surface
  static constexpr float kMinCosine = 0.866F;  ///< of corresponding normals: 30 degrees

  /// points    n >= 1 positions [m]
  /// normals   n unit vectors; samples whose normal is NaN are left out
  /// diameter  > 0 [m]
  SampledSurface(PointsView points, NormalsView normals, float diameter);

  std::size_t size() const noexcept { return points_.size(); }
  PointsView points() const noexcept { return points_; }
  NormalsView normals() const noexcept { return normals_; }
  float slack() const noexcept { return slack_; }

  /// How badly a motion (of this frame) maps the surface onto itself, beyond the error of sampling;
  /// up to 1 is a symmetry. The largest of: mean square distance over tolerance^2; the share of
  /// samples farther than three tolerances, over 2 %; the share farther than six, over 0.25 %.
  /// The last keeps small features that a pose must respect: a handle, a key, a notch.
  /// Looks at num_queries samples, spread over the surface. Where the misfit exceeds `give_up`,
  /// some number above that, found early.
  float misfit(const Pose& motion, float tolerance, float give_up,
               std::size_t num_queries) const noexcept;

  /// Which of the first samples a motion (of this frame) brings within `distance` < kCap of the
  /// surface, normals agreeing: 1 or 0 for each. Pre: out.size() <= size().
  void mark_matched(const Pose& motion, float distance, std::span<std::uint8_t> out) const noexcept;

  /// Bring a motion that almost maps the surface onto itself closer to doing so; point-to-plane
  /// steps on num_queries samples, damped so that a motion along the surface stays as it is.
  Pose refine(Pose motion, std::size_t num_queries, int num_steps) const noexcept;

  /// The motion in the frame and unit of the samples as they were given.
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
  /// None where nothing is nearer than `cap`, but for the sample that stands at a place of the grid.
  Match match(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float slack,
              std::uint32_t excluded, float cap = kCap) const noexcept;
  /// Call visit(samples, runs) with runs that together hold all samples within a radius, which is
  /// kCap + kMaxSlack at most.
  template <class Visit>
  void visit_runs(const Eigen::Vector3f& point, float radius, Visit&& visit) const noexcept;

  Eigen::Vector3f center_{0, 0, 0};
  float diameter_ = 1;
  float slack_ = 0;       // of most samples
  Column<float> slacks_;  // of each
  Points points_;
  Normals normals_;
  VoxelHash grid_;
  // In the grid's order; behind them what fills a vector's lanes and matches nothing.
  Points sorted_points_;
  Normals sorted_normals_;
  Column<float> own_distances_;  // of each sample from all others
};

}  // namespace trivet::kernels
