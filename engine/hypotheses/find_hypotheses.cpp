#include "engine/hypotheses/find_hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include "engine/common/parallel.hpp"
#include "kernels/pair_features/scene_pairs.hpp"
#include "kernels/pair_features/vote.hpp"
#include "storage/common/clamped_integer.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kMaxPairs = 8000;  // maximum per reference, so that 16-bit counters suffice

/// Scratch memory of a voting thread. Nothing in it outlives one reference point.
struct VoteScratch {
  explicit VoteScratch(std::size_t num_points) : pairs(num_points) {}
  std::vector<std::uint32_t> indices;
  Points points;
  Normals normals;
  kernels::PairScratch pairs;
  kernels::VoteKeys keys;
  std::vector<kernels::SceneVote> votes;
  Column<std::uint16_t> accumulator;
  std::uint64_t num_pairs = 0, num_votes = 0;
};

void gather_neighbors(const SceneLevel& level, const Eigen::Vector3f& center, float radius,
                      VoteScratch& scratch) {
  scratch.indices.clear();
  level.grid.visit_within(center, radius,
                          [&](std::uint32_t i, float) { scratch.indices.push_back(i); });
  const std::size_t step = 1 + scratch.indices.size() / kMaxPairs;
  const std::size_t n = (scratch.indices.size() + step - 1) / step;
  scratch.points.resize(n);
  scratch.normals.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    scratch.points.set(k, level.points[scratch.indices[k * step]]);
    scratch.normals.set(k, level.normals[scratch.indices[k * step]]);
  }
}

/// The quantization of the largest table serves all tables. Keys of equal step differ only in their
/// maximum distance, which the ball limits.
PpfQuantization shared_quantization(std::span<const ModelPairs* const> models, float radius) {
  PpfQuantization quantization;
  for (const ModelPairs* const model : models) {
    const PpfQuantization& own = model->ppf.quantization;
    if (own.num_distance_bins > quantization.num_distance_bins) quantization = own;
  }
  quantization.num_distance_bins =
      clamped_integer(std::ceil(radius * static_cast<float>(quantization.num_distance_bins)), 0U,
                      quantization.num_distance_bins);
  return quantization;
}

/// The pose of the model at a peak.
Pose pose_of(const kernels::VotePeak& peak, const ModelPairs& model, const Pose& T_scene_frame) {
  Pose turn = Pose::Identity();
  turn.linear() = Eigen::AngleAxisf(peak.rotation_rad, Eigen::Vector3f::UnitX()).toRotationMatrix();
  const Pose T_frame_model = kernels::frame_pose(kernels::reference_frame(
      model.ppf_points[peak.model_point], model.ppf_normals[peak.model_point]));
  return T_scene_frame * turn * T_frame_model;
}

/// What all reference points vote on. All is referred to.
struct Voting {
  std::span<const ModelPairs* const> models;
  const SceneLevel& level;
  const PpfQuantization& quantization;
  const VoteOptions& options;
};

/// Let one reference point vote for each model, and write the hypotheses of its peaks.
///
/// out  options.max_peaks for each model; without votes where there are fewer peaks
void vote_from(const Voting& voting, std::uint32_t reference, VoteScratch& scratch,
               std::span<kernels::Hypothesis> out) {
  const auto& [models, level, quantization, options] = voting;
  const kernels::ReferenceFrame frame =
      kernels::reference_frame(level.points[reference], level.normals[reference]);
  const float radius =
      quantization.distance_step * static_cast<float>(quantization.num_distance_bins);
  gather_neighbors(level, frame.point, radius, scratch);
  kernels::collect_scene_votes(frame, {scratch.points, scratch.normals},
                               {quantization, options.neighbor_share}, scratch.pairs, scratch.keys,
                               scratch.votes);
  if (scratch.votes.size() > kMaxPairs) scratch.votes.resize(kMaxPairs);
  scratch.num_pairs += scratch.points.size();
  const Pose T_scene_frame = kernels::frame_pose(frame).inverse();
  for (std::size_t m = 0; m < models.size(); ++m) {
    const ModelPairs& model = *models[m];
    if (model.ppf.entries.empty()) continue;
    check_stop();
    scratch.accumulator.resize(model.ppf.num_references * kernels::kRotationBins);
    scratch.num_votes +=
        kernels::cast_votes(scratch.votes, model.ppf, options.max_votes, scratch.accumulator);
    const kernels::VotePeaks peaks =
        kernels::extract_peaks(scratch.accumulator, options.max_peaks, options.peak_share);
    for (std::size_t k = 0; k < peaks.count; ++k) {
      out[m * options.max_peaks + k] = {pose_of(peaks.peak[k], model, T_scene_frame),
                                        static_cast<float>(peaks.peak[k].votes)};
    }
  }
}

}  // namespace

VotedHypotheses find_hypotheses(std::span<const ModelPairs* const> models, const SceneLevel& level,
                                const VoteOptions& options) {
  const PpfQuantization quantization = shared_quantization(models, options.radius);
  const std::size_t slots = models.size() * options.max_peaks;
  std::vector<kernels::Hypothesis> found(level.references.size() * slots);
  PerThread<VoteScratch> per_thread(
      [&] { return VoteScratch(std::min(level.points.size(), kMaxPairs + 1)); });
  const Voting voting{models, level, quantization, options};
  for_chunks(level.references.size(), 4, [&](std::size_t first, std::size_t count) {
    VoteScratch& scratch = per_thread.local();
    for (std::size_t r = first; r < first + count; ++r) {
      vote_from(voting, level.references[r], scratch, std::span(found).subspan(r * slots, slots));
    }
  });

  VotedHypotheses voted;
  voted.num_references = level.references.size();
  for (const VoteScratch& scratch : per_thread) {
    voted.num_pairs += scratch.num_pairs;
    voted.num_votes += scratch.num_votes;
  }
  voted.of_model.resize(models.size());
  for (std::size_t slot = 0; slot < found.size(); ++slot) {
    if (found[slot].votes > 0)
      voted.of_model[slot % slots / options.max_peaks].push_back(found[slot]);
  }
  return voted;
}

}  // namespace trivet::engine
