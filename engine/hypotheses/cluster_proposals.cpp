#include "engine/hypotheses/cluster_proposals.hpp"

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "engine/common/parallel.hpp"
#include "kernels/verification/cluster_poses.hpp"

namespace trivet::engine {
namespace {

constexpr float kRadiansPerDegree = std::numbers::pi_v<float> / 180;
// Multiple of max_clusters up to which clusters are recorded, if those given up are: it bounds memory.
constexpr std::size_t kKeptShare = 4;

struct Clusters {
  std::vector<kernels::Hypothesis> poses;  // sorted by falling votes
  float num_votes = 0;                     // sum over all hypotheses
};

Clusters cluster(const ModelInfo& model, const Proposals& proposals,
                 const ClusterProposalsOptions& options) {
  const kernels::ClusterOptions limits{
      options.pose.cluster_translation * model.diameter,
      options.pose.cluster_rotation_deg * kRadiansPerDegree,
      std::size_t{options.pose.max_clusters} * (options.keep_given_up ? kKeptShare : 1)};
  Clusters clusters;
  for (const kernels::Hypothesis& hypothesis : proposals.hypotheses)
    clusters.num_votes += hypothesis.votes;
  clusters.poses =
      kernels::cluster_poses(proposals.hypotheses, model.symmetry, model.center, limits);
  return clusters;
}

}  // namespace

std::vector<Row> cluster_proposals(const Library& library, std::span<const Proposals> proposals,
                                   const ClusterProposalsOptions& options, PoseTable& table) {
  std::vector<const Proposals*> by_model;
  for (const Proposals& of_model : proposals) by_model.push_back(&of_model);
  std::ranges::stable_sort(by_model, {}, &Proposals::model);
  std::vector<Clusters> clusters(by_model.size());
  for_each_index(by_model.size(), [&](std::size_t k) {
    clusters[k] = cluster(library.models[by_model[k]->model], *by_model[k], options);
  });

  PoseTable all;
  std::vector<Row> open, given_up;
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    const ModelInfo& model = library.models[by_model[k]->model];
    const std::vector<kernels::Hypothesis>& poses = clusters[k].poses;
    for (std::size_t c = 0; c < poses.size(); ++c) {
      if (!options.limits.allow(poses[c].T_scene_model, model.center, 1 / options.scale)) continue;
      const bool is_weak = c >= options.pose.max_clusters ||
                           poses[c].votes < options.pose.min_cluster_share * poses[0].votes;
      (is_weak ? given_up : open)
          .push_back(all.add(by_model[k]->model, by_model[k]->source, poses[c].T_scene_model,
                             poses[c].votes, poses[c].votes / clusters[k].num_votes));
    }
  }
  const std::vector<Row> strongest = extract_best(all.votes, options.max_rows, open);
  const auto append = [&](Row row) {
    return table.add(all.model[row], all.source[row], all.T_proposed[row], all.votes[row],
                     all.share[row]);
  };
  std::vector<Row> rows;
  rows.reserve(strongest.size());
  for (const Row row : strongest) rows.push_back(append(row));
  if (options.keep_given_up) {
    given_up.insert(given_up.end(), open.begin(), open.end());
    for (const Row row : given_up) table.fate[append(row)] = PoseFate::given_up;
  }
  return rows;
}

}  // namespace trivet::engine
