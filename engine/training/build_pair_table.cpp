#include "engine/training/build_pair_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/common/parallel.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "kernels/pair_features/ppf_table.hpp"
#include "storage/common/clamped_integer.hpp"

namespace trivet::engine {
namespace {

constexpr float kRadiansPerDegree = std::numbers::pi_v<float> / 180;
constexpr std::size_t kPairGrain = 16;  // references per task, each paired with all points
constexpr std::size_t kTableChunks =
    8;  // fixed, so that the table does not depend on the number of threads
constexpr std::uint32_t kMostDistances = 1U << 20;
constexpr std::size_t kMaxPpfPoints = 65536;  // maximum for a 16-bit reference

struct TableStorage {
  Column<std::uint32_t> offsets;
  Column<PpfEntry> entries;
};

/// The views of the nearest sample with a similar normal, for the co-visibility of pairs.
std::vector<ViewMask> views_of_points(const SurveyedModel& model, const SpreadPoints& surface) {
  const SpreadPoints& samples = model.samples;
  const kernels::VoxelHash grid(samples.points, 2 * samples.spacing);
  std::vector<ViewMask> views(surface.points.size());
  for_chunks(views.size(), 256, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      // All near samples together, since the point may be visible whenever any of them is.
      ViewMask mask{};
      grid.visit_within(surface.points[i], 2 * samples.spacing, [&](std::uint32_t s, float) {
        if (samples.normals[s].dot(surface.normals[i]) < 0.8F) return;
        for (std::size_t w = 0; w < kViewWords; ++w) mask[w] |= model.sample_views[s][w];
      });
      if (mask == ViewMask{}) mask.fill(~std::uint64_t{0});
      views[i] = mask;
    }
  });
  return views;
}

/// Sort the reference points to the front: one of each set of symmetric copies, `spacing` apart.
/// Returns their number.
std::size_t references_first(const Symmetry& symmetry, float step, float spacing,
                             SpreadPoints& surface) {
  std::vector<std::uint8_t> is_reference(surface.points.size(), 1);
  kernels::choose_references(surface.points, symmetry, step, is_reference);
  kernels::spread_references(surface.points, surface.normals, spacing, is_reference);
  std::vector<std::uint32_t> order(is_reference.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto rest = std::stable_partition(order.begin(), order.end(),
                                          [&](std::uint32_t i) { return is_reference[i] != 0; });
  const Points points = surface.points;
  const Normals normals = surface.normals;
  for (std::size_t k = 0; k < order.size(); ++k) {
    surface.points.set(k, points[order[k]]);
    surface.normals.set(k, normals[order[k]]);
  }
  return static_cast<std::size_t>(rest - order.begin());
}

/// Count, scan and fill. The result has no entries if there are no pairs, or more than a table can
/// store.
TableStorage fill_table(const kernels::PpfPoints& points, const PpfQuantization& quantization,
                        std::size_t num_references) {
  const std::size_t num_cells = quantization.num_cells();
  const std::size_t num_chunks =
      std::min(kTableChunks, (num_references + kPairGrain - 1) / kPairGrain);
  const auto chunk_first = [&](std::size_t chunk) { return num_references * chunk / num_chunks; };
  const auto chunk_size = [&](std::size_t chunk) {
    return chunk_first(chunk + 1) - chunk_first(chunk);
  };

  TableStorage table;
  table.offsets.resize(num_cells + 1);
  Column<std::uint32_t> counts(num_chunks * num_cells, 0);
  const auto counts_of = [&](std::size_t chunk) {
    return std::span(counts).subspan(chunk * num_cells, num_cells);
  };
  PerThread<kernels::PairScratch> scratch(
      [&] { return kernels::PairScratch(points.points.size()); });
  for_each_index(num_chunks, [&](std::size_t chunk) {
    kernels::count_ppf_pairs({points, quantization, chunk_first(chunk), chunk_size(chunk)},
                             scratch.local(), counts_of(chunk));
  });
  table.entries.resize(kernels::scan_ppf_counts(counts, num_chunks, table.offsets));
  if (table.entries.empty()) return table;
  for_each_index(num_chunks, [&](std::size_t chunk) {
    kernels::fill_ppf_entries({points, quantization, chunk_first(chunk), chunk_size(chunk)},
                              scratch.local(), counts_of(chunk), table.entries);
  });
  for_chunks(num_cells, 4096, [&](std::size_t first, std::size_t count) {
    kernels::sort_ppf_cells(table.offsets, first, count, table.entries);
  });
  return table;
}

}  // namespace

PairTableOptions pair_table_options(const TrainOptions& options) {
  return {.relative_step = options.relative_step,
          .reference_spacing = options.reference_spacing,
          .num_angle_bins = options.num_angle_bins,
          .normal_cluster_angle_deg = options.normal_cluster_angle_deg};
}

Result<PairTable> build_pair_table(const SurveyedModel& model, const Symmetry& symmetry,
                                   const PairTableOptions& options, const ModelSource& source,
                                   StageTimes& times) {
  const float step = sampling_step(model.diameter, options.relative_step);
  SpreadPoints surface;
  {
    const StageTimer timer(times, "subsample");
    surface = sample_evenly(model, step, options.normal_cluster_angle_deg * kRadiansPerDegree);
    drop_hidden(model, surface);
  }
  const std::size_t n = surface.points.size();
  if (n < 10 || n > kMaxPpfPoints) {
    return bad_surface(source, fmt::format("{} sampled points at step {} (10 to {} can be used)", n,
                                           step, kMaxPpfPoints));
  }
  const StageTimer timer(times, "table");
  const std::size_t num_references =
      references_first(symmetry, step, options.reference_spacing * step, surface);
  const std::vector<ViewMask> views = views_of_points(model, surface);
  const PpfQuantization quantization{
      step, clamped_integer(std::ceil(model.diameter / step), 1U, kMostDistances),
      options.num_angle_bins};
  const auto table = std::make_shared<const TableStorage>(
      fill_table({surface.points, surface.normals, views}, quantization, num_references));
  if (table->entries.empty()) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: model '{}': expected 1 to 2^32 point pairs, found {} points that "
                             "give none or more; "
                             "choose another relative step than {}",
                             source.file.string(), source.name, n, options.relative_step)};
  }
  return PairTable{
      std::move(surface.points),
      std::move(surface.normals),
      {quantization, static_cast<std::uint32_t>(num_references), table->offsets, table->entries},
      table};
}

}  // namespace trivet::engine
