/// Variable-length rows of indices in compressed sparse row form (CSR).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "storage/common/columns.hpp"
#include "storage/common/precondition.hpp"

namespace trivet {

/// Read-only view of m rows of indices; valid while the owner lives and keeps its size.
struct NeighborhoodsView {
  std::span<const std::uint32_t> offsets;  ///< m + 1, non-decreasing
  std::span<const std::uint32_t> indices;  ///< row i is indices[offsets[i] .. offsets[i + 1])

  std::size_t size() const noexcept { return offsets.empty() ? 0 : offsets.size() - 1; }
  std::span<const std::uint32_t> row(std::size_t i) const noexcept {
    return indices.subspan(offsets[i], offsets[i + 1] - offsets[i]);
  }
  NeighborhoodsView rows(std::size_t first, std::size_t count) const {
    TRIVET_REQUIRE(first <= size() && count <= size() - first, "rows within the table");
    return {offsets.subspan(first, count + 1), indices};
  }
};

/// Owning storage of rows of indices.
struct Neighborhoods {
  Column<std::uint32_t> offsets, indices;

  NeighborhoodsView view() const noexcept { return {offsets, indices}; }
  operator NeighborhoodsView() const noexcept {
    return view();
  }  // NOLINT: an owner reads as its view
};

}  // namespace trivet
