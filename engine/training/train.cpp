#include "engine/train.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/common/parallel.hpp"
#include "engine/training/describe_model.hpp"
#include "engine/training/encode_features.hpp"
#include "engine/training/model_surface.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "kernels/pair_features/ppf_table.hpp"

namespace trivet {
namespace {

using engine::for_chunks;

constexpr float kRadiansPerDegree = 3.14159265358979F / 180;
constexpr std::size_t kPairGrain = 16;  // references a task; each pairs with all points
constexpr std::size_t kTableChunks =
    8;  // fixed, so that the table does not depend on the number of threads
constexpr std::size_t kMaxPpfPoints = 65536;  // what a 16-bit reference can name

struct PpfTable {
  Column<std::uint32_t> offsets;
  Column<PpfEntry> entries;
};

/// The views of the nearest sample with a like normal, for the co-visibility of pairs.
std::vector<ViewMask> views_of_points(const Model& model) {
  const kernels::VoxelHash grid(model.samples, 2 * model.sample_spacing);
  std::vector<ViewMask> views(model.ppf_points.size());
  for_chunks(views.size(), 256, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      // All near samples together: what any of them sees, the point may see.
      ViewMask mask{};
      grid.visit_within(model.ppf_points[i], 2 * model.sample_spacing, [&](std::uint32_t s, float) {
        if (model.sample_normals[s].dot(model.ppf_normals[i]) < 0.8F) return;
        for (std::size_t w = 0; w < kViewWords; ++w) mask[w] |= model.sample_views[s][w];
      });
      if (mask == ViewMask{}) mask.fill(~std::uint64_t{0});
      views[i] = mask;
    }
  });
  return views;
}

/// Put the points that pairs start at first: one of each set of symmetric copies, `spacing` apart.
/// Returns how many there are.
std::size_t references_first(float step, float spacing, Model& model) {
  std::vector<std::uint8_t> is_reference(model.ppf_points.size(), 1);
  kernels::choose_references(model.ppf_points, model.symmetry, step, is_reference);
  kernels::spread_references(model.ppf_points, model.ppf_normals, spacing, is_reference);
  std::vector<std::uint32_t> order(is_reference.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto rest = std::stable_partition(order.begin(), order.end(),
                                          [&](std::uint32_t i) { return is_reference[i] != 0; });
  const Points points = model.ppf_points;
  const Normals normals = model.ppf_normals;
  for (std::size_t k = 0; k < order.size(); ++k) {
    model.ppf_points.set(k, points[order[k]]);
    model.ppf_normals.set(k, normals[order[k]]);
  }
  return static_cast<std::size_t>(rest - order.begin());
}

/// `model.ppf` has the step of its quantization.
Result<void> build_table(const ModelSource& source, const TrainOptions& options,
                         const engine::ModelSurface& surface, TrainedModel& trained) {
  Model& model = trained.model;
  TrainStats& stats = trained.stats;
  const float step = model.ppf.quantization.distance_step;
  {
    const StageTimer timer(stats.times, "subsample");
    engine::sample_evenly(model, surface, step,
                          options.normal_cluster_angle_deg * kRadiansPerDegree, model.ppf_points,
                          model.ppf_normals);
  }
  stats.num_ppf_points = model.ppf_points.size();
  if (stats.num_ppf_points < 10 || stats.num_ppf_points > kMaxPpfPoints) {
    return engine::bad_surface(source,
                               fmt::format("{} sampled points at step {} (10 to {} can be used)",
                                           stats.num_ppf_points, step, kMaxPpfPoints));
  }
  const StageTimer timer(stats.times, "table");
  const std::size_t num_references =
      references_first(step, options.reference_spacing * step, model);
  const std::vector<ViewMask> views = views_of_points(model);
  const kernels::PpfPoints points{model.ppf_points, model.ppf_normals, views};
  PpfQuantization quantization{step, static_cast<std::uint32_t>(std::ceil(model.diameter / step)),
                               options.num_angle_bins};
  const std::size_t num_cells = quantization.num_cells();
  const std::size_t n = model.ppf_points.size();
  const std::size_t num_chunks =
      std::min(kTableChunks, (num_references + kPairGrain - 1) / kPairGrain);
  const auto chunk_first = [&](std::size_t chunk) { return num_references * chunk / num_chunks; };

  auto table = std::make_shared<PpfTable>();
  table->offsets.resize(num_cells + 1);
  Column<std::uint32_t> counts(num_chunks * num_cells, 0);
  engine::PerThread<kernels::PairScratch> scratch([&] { return kernels::PairScratch(n); });
  engine::for_each_index(num_chunks, [&](std::size_t chunk) {
    kernels::count_ppf_pairs(points, quantization, chunk_first(chunk),
                             chunk_first(chunk + 1) - chunk_first(chunk), scratch.local(),
                             std::span(counts).subspan(chunk * num_cells, num_cells));
  });
  const std::uint64_t num_entries = kernels::scan_ppf_counts(counts, num_chunks, table->offsets);
  if (num_entries == 0) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: model '{}': expected 1 to 2^32 point pairs, found {} points that "
                             "give none or more; "
                             "choose another relative step than {}",
                             source.file.string(), source.name, n, options.relative_step)};
  }
  table->entries.resize(num_entries);
  engine::for_each_index(num_chunks, [&](std::size_t chunk) {
    kernels::fill_ppf_entries(
        points, quantization, chunk_first(chunk), chunk_first(chunk + 1) - chunk_first(chunk),
        scratch.local(), std::span(counts).subspan(chunk * num_cells, num_cells), table->entries);
  });
  for_chunks(num_cells, 4096, [&](std::size_t first, std::size_t count) {
    kernels::sort_ppf_cells(table->offsets, first, count, table->entries);
  });
  model.ppf = {quantization, static_cast<std::uint32_t>(num_references), table->offsets,
               table->entries};
  model.ppf_storage = std::move(table);
  stats.num_ppf_entries = num_entries;
  return {};
}

}  // namespace

float sampling_step(float diameter, float relative_step) {
  return relative_step * std::exp2(std::round(4 * std::log2(diameter)) / 4);
}

Result<TrainedModel> train_model(const Cloud& cloud, const ModelSource& source,
                                 const TrainOptions& options, const TriSpinBasis& basis) {
  TrainedModel trained;
  Model& model = trained.model;
  const Result<engine::ModelSurface> surface =
      engine::survey_model(cloud, source, options, model, trained.stats);
  if (!surface) return surface.error();
  engine::find_symmetries(source, model, trained.stats);
  model.ppf.quantization.distance_step = sampling_step(model.diameter, options.relative_step);
  if (options.point_pairs) {
    if (const Result<void> built = build_table(source, options, *surface, trained); !built)
      return built.error();
  }
  if (basis.components.size() > 0) {
    const StageTimer timer(trained.stats.times, "describe");
    model.features =
        engine::encode_features(engine::describe_model(model, *surface, {.support = basis.support}),
                                basis, engine::resolution_for(model.diameter));
    trained.stats.num_features = model.features.size();
  }
  return trained;
}

}  // namespace trivet
