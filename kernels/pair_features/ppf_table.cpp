#include "kernels/pair_features/ppf_table.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "kernels/common/voxel_hash.hpp"
#include "storage/common/precondition.hpp"

namespace trivet::kernels {

PairScratch::PairScratch(std::size_t num_points)
    : distance(num_points),
      angle1(num_points),
      angle2(num_points),
      angle3(num_points),
      rotation(num_points),
      cells(num_points),
      rotations(num_points) {}

PairFeaturesSpan PairScratch::features(std::size_t n) noexcept {
  const auto first = [n](Column<float>& column) { return std::span<float>(column).first(n); };
  return {first(distance), first(angle1), first(angle2), first(angle3), first(rotation)};
}

namespace {

bool share_view(const ViewMask& a, const ViewMask& b) noexcept {
  std::uint64_t common = 0;
  for (std::size_t w = 0; w < kViewWords; ++w) common |= a[w] & b[w];
  return common != 0;
}

/// Call body(reference, cell, rotation) for every pair that belongs in the table.
template <class Body>
void for_each_pair(const PpfChunk& chunk, PairScratch& scratch, Body&& body) noexcept {
  const PpfPoints& model = chunk.model;
  const std::size_t n = model.points.size();
  assert(scratch.cells.size() >= n && "scratch holds one model's points");
  const PairFeaturesSpan features = scratch.features(n);
  for (std::size_t reference = chunk.first; reference < chunk.first + chunk.count; ++reference) {
    compute_pair_features(reference_frame(model.points[reference], model.normals[reference]),
                          model.points, model.normals, features);
    quantize_pair_features(chunk.quantization, features, std::span(scratch.cells).first(n),
                           std::span(scratch.rotations).first(n));
    for (std::size_t i = 0; i < n; ++i) {
      if (scratch.cells[i] == kNoCell) continue;
      if (!model.views.empty() && !share_view(model.views[reference], model.views[i])) continue;
      body(reference, scratch.cells[i], scratch.rotations[i]);
    }
  }
}

}  // namespace

void choose_references(PointsView points, const Symmetry& symmetry, float margin,
                       std::span<std::uint8_t> is_reference) noexcept {
  // Any direction in general position. With an axis, only the component along it is used: the strip
  // handles the rest.
  const Eigen::Vector3f general = Eigen::Vector3f(0.8411F, 0.4587F, 0.2872F).normalized();
  Eigen::Vector3f axis = Eigen::Vector3f::Zero(), across = Eigen::Vector3f::Zero(),
                  aside = Eigen::Vector3f::Zero();
  Eigen::Vector3f foot = Eigen::Vector3f::Zero(), along = general;
  if (symmetry.axis) {
    axis = symmetry.axis->direction;
    foot = symmetry.axis->point;
    along = axis;
    across = (general - axis * axis.dot(general)).normalized();
    aside = axis.cross(across);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = points[i];
    bool chosen = true;
    for (const Pose& S : symmetry.poses) chosen = chosen && along.dot(S * p - p) <= margin;
    if (symmetry.axis) {
      const Eigen::Vector3f d = p - foot;
      chosen = chosen && std::abs(d.dot(aside)) <= margin && d.dot(across) >= -margin;
    }
    is_reference[i] = chosen;
  }
}

void spread_references(PointsView points, NormalsView normals, float distance,
                       std::span<std::uint8_t> is_reference) {
  TRIVET_REQUIRE(normals.size() == points.size() && is_reference.size() == points.size(),
                 "one normal and one mark per point");
  if (!(distance > 0)) return;
  constexpr float kLikeCosine = 0.7071F;
  const VoxelHash grid(points, distance);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (is_reference[i] == 0) continue;
    const Eigen::Vector3f normal = normals[i];
    grid.visit_within(points[i], distance, [&](std::uint32_t k, float) {
      if (k > i && normals[k].dot(normal) >= kLikeCosine) is_reference[k] = 0;
    });
  }
}

void count_ppf_pairs(const PpfChunk& chunk, PairScratch& scratch,
                     std::span<std::uint32_t> counts) noexcept {
  for_each_pair(chunk, scratch,
                [&](std::size_t, std::uint32_t cell, std::uint16_t) { ++counts[cell]; });
}

std::uint64_t scan_ppf_counts(std::span<std::uint32_t> counts, std::size_t num_chunks,
                              std::span<std::uint32_t> offsets) noexcept {
  const std::size_t num_cells = offsets.size() - 1;
  std::uint64_t total = 0;
  for (std::size_t cell = 0; cell < num_cells; ++cell) {
    offsets[cell] = static_cast<std::uint32_t>(total);
    for (std::size_t chunk = 0; chunk < num_chunks; ++chunk) {
      std::uint32_t& at = counts[chunk * num_cells + cell];
      const std::uint32_t here = at;
      at = static_cast<std::uint32_t>(total);
      total += here;
    }
    if (total > std::numeric_limits<std::uint32_t>::max()) return 0;
  }
  offsets[num_cells] = static_cast<std::uint32_t>(total);
  return total;
}

void fill_ppf_entries(const PpfChunk& chunk, PairScratch& scratch,
                      std::span<std::uint32_t> positions, std::span<PpfEntry> entries) noexcept {
  for_each_pair(chunk, scratch,
                [&](std::size_t reference, std::uint32_t cell, std::uint16_t rotation) {
                  entries[positions[cell]++] = {static_cast<std::uint16_t>(reference), rotation};
                });
}

void sort_ppf_cells(std::span<const std::uint32_t> offsets, std::size_t first, std::size_t count,
                    std::span<PpfEntry> entries) noexcept {
  // References already ascend; only runs of one reference are unsorted, and they are short.
  const auto before = [](const PpfEntry& a, const PpfEntry& b) {
    return a.reference != b.reference ? a.reference < b.reference : a.angle < b.angle;
  };
  for (std::size_t cell = first; cell < first + count; ++cell) {
    for (std::size_t i = offsets[cell] + 1; i < offsets[cell + 1]; ++i) {
      const PpfEntry entry = entries[i];
      std::size_t j = i;
      for (; j > offsets[cell] && before(entry, entries[j - 1]); --j) entries[j] = entries[j - 1];
      entries[j] = entry;
    }
  }
}

}  // namespace trivet::kernels
