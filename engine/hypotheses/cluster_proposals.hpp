/// Clustering of proposals into rows of the pose table.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "engine/hypotheses/proposals.hpp"
#include "engine/options/recognize_options.hpp"
#include "engine/poses/pose_table.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

struct ClusterProposalsOptions {
  PoseOptions pose{};
  PoseLimits limits{};
  double scale = 1;  ///< factor from the limits' unit to the library's
  /// Maximum number of rows; those with the most votes are kept.
  std::size_t max_rows = std::numeric_limits<std::size_t>::max();
  /// Whether to append the next best rows beyond the limits on numbers too, as given up.
  bool keep_given_up = false;
};

/// Cluster the proposals of each source and model separately, and append the clusters within the
/// pose limits as rows of the table.
/// Returns the rows to continue with, by model and then in the order of the proposals, the
/// strongest first. Same bytes for any number of threads.
std::vector<Row> cluster_proposals(const Library& library, std::span<const Proposals> proposals,
                                   const ClusterProposalsOptions& options, PoseTable& table);

}  // namespace trivet::engine
