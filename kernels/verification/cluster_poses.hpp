/// Clustering of pose hypotheses.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/common/hypothesis.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

struct ClusterOptions {
  float max_translation = 0;   ///< limit on the distance between the images of the model's center
                               ///< [scene unit], > 0
  float max_rotation_rad = 0;  ///< limit on the angle between rotations, > 0
  std::size_t max_clusters = 600;  ///< the strongest are kept
};

/// Cluster by complete linkage, strongest first: a hypothesis joins the first cluster of which
/// *every* member is within both limits, so that chains never average two objects into one (Vidal
/// et al., Sensors 2018).
///
/// hypotheses   any order; ties in votes are broken by position
/// Distances are modulo the model's symmetry. A cluster's pose is the mean weighted by votes, of
/// members moved to the symmetric branch of the strongest; its votes are the sum. Returns clusters
/// by descending votes. Cost: linear in hypotheses times those in neighboring cells of a grid over
/// the centers.
std::vector<Hypothesis> cluster_poses(std::span<const Hypothesis> hypotheses,
                                      const Symmetry& symmetry, const Eigen::Vector3f& model_center,
                                      const ClusterOptions& options);

}  // namespace trivet::kernels
