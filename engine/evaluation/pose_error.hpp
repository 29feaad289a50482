/// Error of an estimated pose.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "engine/evaluation/evaluation_meshes.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "storage/data/model.hpp"

namespace trivet::engine {

struct PoseError {
  double translation = 0;  ///< error of the center of the model's bounding box [diameters]
  double rotation_deg = 0;

  /// Whether the errors are below a tenth of the diameter and below 12 degrees.
  /// Source: Drost et al., CVPR 2010, section 5.
  bool right() const noexcept;
  /// Sum of both errors relative to their limits; lower is nearer.
  double rank() const noexcept;
};

/// Measures poses of one model. Not thread-safe.
class PoseJudge {
 public:
  /// mesh  must outlive the judge
  explicit PoseJudge(const EvaluationMesh& mesh);

  /// The error with the lowest rank over the symmetries. The turn about a free axis is ignored.
  PoseError error(const Pose& estimate, const Pose& truth) const;

  /// Mean distance between the vertices of both poses [diameters]; for a model with a symmetry,
  /// from each vertex to the nearest one (ADD-S). Models with more vertices are subsampled evenly
  /// to 3,000. Source: Hinterstoisser et al., ACCV 2012.
  double add(const Pose& estimate, const Pose& truth);

 private:
  PoseError error_of_one(const Pose& estimate, const Pose& truth) const;
  double distance_to_vertices(const Eigen::Vector3d& point);

  const EvaluationMesh& mesh_;
  Eigen::Vector3d center_;
  std::optional<kernels::VoxelHash> grid_;  // for ADD-S only
};

}  // namespace trivet::engine
