/// From proposals to rows of the pose table.
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
  double scale = 1;  ///< of the limits' unit to the library's
  std::size_t max_rows = std::numeric_limits<std::size_t>::max();  ///< those of most votes
  bool keep_all = false;  ///< also as rows: what the limits on numbers leave out, given up
};

/// Cluster what each source proposes for each model, the sources for themselves, and append the
/// clusters as rows of the table, but those beyond the limits of poses.
/// Returns the rows to go on with, by model and then in the order of the proposals, the strongest
/// first. Same bytes for any number of threads.
std::vector<Row> cluster_proposals(const Library& library, std::span<const Proposals> proposals,
                                   const ClusterProposalsOptions& options, PoseTable& table);

}  // namespace trivet::engine
