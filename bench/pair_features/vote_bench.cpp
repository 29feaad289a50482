// Voting of every reference point of the scan for the bracket, one thread. Both implementations use
// the same look-ups and table.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "kernels/pair_features/vote.hpp"
#include "parts.hpp"

namespace trivet::bench {
namespace {

using kernels::kRotationBins;

/// The look-ups of each reference point.
struct Sweep {
  const Model& model;
  std::vector<std::vector<kernels::SceneVote>> references;
};

Sweep make_sweep() {
  Sweep sweep{trained_parts(kDefaultStep)[0], {}};
  const VoteOptions options;
  PpfQuantization quantization = sweep.model.ppf.quantization;
  quantization.num_distance_bins = static_cast<std::uint32_t>(
      std::ceil(options.radius * static_cast<float>(quantization.num_distance_bins)));
  const float radius =
      quantization.distance_step * static_cast<float>(quantization.num_distance_bins);
  const engine::SceneLevel level = engine::choose_voters(
      prepared_scan(),
      engine::sample_scene(prepared_scan(), quantization.distance_step, sweep.model.diameter),
      options);
  kernels::PairScratch scratch(level.points.size());
  kernels::VoteKeys keys;
  for (const std::uint32_t r : level.references) {
    Points points;
    Normals normals;
    level.grid.visit_within(level.points[r], radius, [&](std::uint32_t i, float) {
      points.push_back(level.points[i]);
      normals.push_back(level.normals[i]);
    });
    kernels::collect_scene_votes(kernels::reference_frame(level.points[r], level.normals[r]),
                                 {points, normals}, {quantization, 0}, scratch, keys,
                                 sweep.references.emplace_back());
  }
  return sweep;
}

const Sweep& sweep() {
  static const Sweep all = make_sweep();
  return all;
}

/// Votes of the highest peak for each reference point, and their total.
struct Outcome {
  std::vector<std::uint32_t> best;
  std::uint64_t num_votes = 0;
};

Outcome vote(Column<std::uint16_t>& accumulator) {
  Outcome outcome;
  for (const auto& votes : sweep().references) {
    outcome.num_votes += kernels::cast_votes(
        votes, sweep().model.ppf, std::numeric_limits<std::uint64_t>::max(), accumulator);
    const kernels::VotePeaks peaks = kernels::extract_peaks(accumulator, 1, 1);
    outcome.best.push_back(peaks.count > 0 ? peaks.peak[0].votes : 0);
  }
  return outcome;
}

struct NaiveEntry {
  std::uint32_t reference;
  double turns;
};
using NaiveTable = std::unordered_multimap<std::uint32_t, NaiveEntry>;

NaiveTable naive_table() {
  const PpfTableView& ppf = sweep().model.ppf;
  NaiveTable table;
  for (std::uint32_t cell = 0; cell + 1 < ppf.offsets.size(); ++cell) {
    for (std::uint32_t e = ppf.offsets[cell]; e < ppf.offsets[cell + 1]; ++e) {
      table.insert({cell, {ppf.entries[e].reference, ppf.entries[e].angle / 65536.0}});
    }
  }
  return table;
}

Outcome naive_vote(const NaiveTable& table) {
  Outcome outcome;
  for (const auto& votes : sweep().references) {
    std::vector<std::uint32_t> accumulator(sweep().model.ppf.num_references * kRotationBins, 0);
    for (const kernels::SceneVote& vote : votes) {
      const auto [first, last] = table.equal_range(vote.cell);
      for (auto entry = first; entry != last; ++entry) {
        double turns = entry->second.turns - vote.rotation / 65536.0;
        if (turns < 0) turns += 1;
        ++accumulator[entry->second.reference * kRotationBins +
                      static_cast<std::uint32_t>(turns * kRotationBins)];
        ++outcome.num_votes;
      }
    }
    std::uint32_t best = 0;
    for (std::size_t row = 0; row < accumulator.size(); row += kRotationBins) {
      for (std::size_t bin = 0; bin < kRotationBins; ++bin) {
        best = std::max(best, accumulator[row + (bin + kRotationBins - 1) % kRotationBins] +
                                  accumulator[row + bin] +
                                  accumulator[row + (bin + 1) % kRotationBins]);
      }
    }
    outcome.best.push_back(best);
  }
  return outcome;
}

void count_votes(benchmark::State& state, std::uint64_t num_votes) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(num_votes));
  state.counters["votes"] = static_cast<double>(num_votes);
  state.counters["references"] = static_cast<double>(sweep().references.size());
}

void ours(benchmark::State& state) {
  Column<std::uint16_t> accumulator(sweep().model.ppf.num_references * kRotationBins, 0);
  Outcome outcome;
  for (auto _ : state) outcome = vote(accumulator);
  count_votes(state, outcome.num_votes);
  const Outcome expected = naive_vote(naive_table());
  double wrong = 0;
  for (std::size_t r = 0; r < expected.best.size(); ++r)
    wrong += outcome.best[r] != expected.best[r];
  state.counters["wrong_peaks"] = wrong;
}
BENCHMARK(ours)->Name("vote/ours")->Unit(benchmark::kMillisecond);

void naive(benchmark::State& state) {
  const NaiveTable table = naive_table();
  Outcome outcome;
  for (auto _ : state) outcome = naive_vote(table);
  count_votes(state, outcome.num_votes);
}
BENCHMARK(naive)->Name("vote/naive")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace trivet::bench
