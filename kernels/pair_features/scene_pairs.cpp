#include "kernels/pair_features/scene_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "kernels/common/fast_angle.hpp"

namespace trivet::kernels {
namespace {

void add(std::uint32_t cell, std::uint16_t rotation, VoteKeys& keys) {
  keys.bins.push_back(std::uint64_t{cell} * kRotationBins + (rotation >> kRotationShift));
  keys.rotations.push_back(rotation);
}

/// The one or two bins of a component, depending on its distance from a border.
struct Bins {
  std::array<std::uint32_t, 2> bin;
  std::uint32_t count;
};

Bins bins_of(float value, float per_bin, std::uint32_t num_bins, float share) noexcept {
  const float position = value * per_bin;
  const std::uint32_t bin = std::min(static_cast<std::uint32_t>(position), num_bins - 1);
  const float fraction = position - static_cast<float>(bin);
  if (fraction < share && bin > 0) return {{bin, bin - 1}, 2};
  if (fraction > 1 - share && bin + 1 < num_bins) return {{bin, bin + 1}, 2};
  return {{bin, 0}, 1};
}

void collect_with_neighbor_cells(const CellLookup& lookup, const PairFeaturesSpan& f,
                                 std::span<const std::uint32_t> cells,
                                 std::span<const std::uint16_t> rotations, VoteKeys& keys) {
  const PpfQuantization& q = lookup.quantization;
  const float share = lookup.neighbor_share;
  const std::uint32_t angles = q.num_angle_bins;
  const float per_angle = static_cast<float>(angles) / std::numbers::pi_v<float>;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] == kNoCell) continue;
    const Bins d = bins_of(f.distance[i], 1.0F / q.distance_step, q.num_distance_bins, share);
    const Bins b1 = bins_of(f.angle_n1_d[i], per_angle, angles, share);
    const Bins b2 = bins_of(f.angle_n2_d[i], per_angle, angles, share);
    const Bins b3 = bins_of(f.angle_n1_n2[i], per_angle, angles, share);
    for (std::uint32_t i0 = 0; i0 < d.count; ++i0) {
      for (std::uint32_t i1 = 0; i1 < b1.count; ++i1) {
        for (std::uint32_t i2 = 0; i2 < b2.count; ++i2) {
          for (std::uint32_t i3 = 0; i3 < b3.count; ++i3) {
            const std::uint32_t cell =
                ((d.bin[i0] * angles + b1.bin[i1]) * angles + b2.bin[i2]) * angles + b3.bin[i3];
            add(cell, rotations[i], keys);
          }
        }
      }
    }
  }
}

}  // namespace

void collect_scene_votes(const ReferenceFrame& reference, const OrientedView& neighbors,
                         const CellLookup& lookup, PairScratch& scratch, VoteKeys& keys,
                         std::vector<SceneVote>& votes) {
  const std::size_t n = neighbors.points.size();
  const PairFeaturesSpan features = scratch.features(n);
  const auto cells = std::span(scratch.cells).first(n);
  const auto rotations = std::span(scratch.rotations).first(n);
  compute_pair_features(reference, neighbors.points, neighbors.normals, features);
  quantize_pair_features(lookup.quantization, features, cells, rotations);

  keys.bins.clear();
  keys.rotations.clear();
  if (lookup.neighbor_share > 0) {
    collect_with_neighbor_cells(lookup, features, cells, rotations, keys);
  } else {
    for (std::size_t i = 0; i < n; ++i) {
      if (cells[i] != kNoCell) add(cells[i], rotations[i], keys);
    }
  }
  const std::uint64_t num_bins = std::uint64_t{lookup.quantization.num_cells()} * kRotationBins;
  radix_sort(keys.bins, keys.rotations, num_bins, keys.sort);

  votes.clear();
  std::uint64_t last = ~std::uint64_t{0};
  for (std::size_t i = 0; i < keys.bins.size(); ++i) {
    const auto rotation = static_cast<std::uint16_t>(keys.rotations[i]);
    if (keys.bins[i] == last) {
      votes.back().rotation = std::min(votes.back().rotation, rotation);
      continue;
    }
    last = keys.bins[i];
    votes.push_back({static_cast<std::uint32_t>(last / kRotationBins), rotation});
  }
}

}  // namespace trivet::kernels
