/// How far an estimated pose is from the true one.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "engine/evaluation/evaluation_meshes.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "storage/data/model.hpp"

namespace trivet::engine {

struct PoseError {
  double translation = 0;  ///< of the middle of the model's bounding box, in diameters
  double rotation_deg = 0;

  /// Below a tenth of the diameter and below 12 degrees.
  /// Source: Drost et al., CVPR 2010, section 5.
  bool right() const noexcept;
  /// Both errors as shares of their limits, added: the lower, the nearer.
  double rank() const noexcept;
};

/// Measures poses of one model. Not for use by two threads at once.
class PoseJudge {
 public:
  /// `mesh` must outlive the judge.
  explicit PoseJudge(const EvaluationMesh& mesh);

  /// The error of the lowest rank over the symmetries; a free axis leaves the turn about it out.
  PoseError error(const Pose& estimate, const Pose& truth) const;

  /// Mean distance between the vertices of both poses, in diameters; for a model with a symmetry
  /// from each vertex to the nearest one (ADD-S). Of many vertices an even choice of 3,000 counts.
  /// Source: Hinterstoisser et al., ACCV 2012.
  double add(const Pose& estimate, const Pose& truth);

 private:
  PoseError error_of_one(const Pose& estimate, const Pose& truth) const;
  double distance_to_vertices(const Eigen::Vector3d& point);

  const EvaluationMesh& mesh_;
  Eigen::Vector3d center_;
  std::optional<kernels::VoxelHash> grid_;  // for ADD-S only
};

}  // namespace trivet::engine
