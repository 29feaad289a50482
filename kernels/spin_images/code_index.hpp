/// Nearest neighbors among the byte codes of millions of features.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace trivet::kernels {

/// An inverted file: each code stands in the list of its nearest centroid, and a query is compared
/// with the codes of a few lists. Distances are squared, of whole numbers, so exact: any processor
/// and any order of comparisons gives the same bits.
///
/// A code takes `stride` bytes, a multiple of 16, filled up with zeros.
/// Source: Sivic, Zisserman, ICCV 2003; Jegou, Douze, Schmid, PAMI 2011, section IV.
struct CodeIndexView {
  std::size_t stride = 0;
  std::span<const std::uint8_t> centroids;  ///< one a list
  std::span<const std::uint32_t> offsets;   ///< where each list begins, and the end of the last
  std::span<const std::uint8_t> codes;      ///< list by list

  std::size_t num_lists() const noexcept { return offsets.empty() ? 0 : offsets.size() - 1; }
  std::size_t size() const noexcept { return offsets.empty() ? 0 : offsets.back(); }
};

struct CodeNeighbor {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t squared = kNone;  ///< distance, in steps of the code
  std::uint32_t index = kNone;    ///< of the code; kNone: there is no neighbor
  auto operator<=>(const CodeNeighbor&) const = default;
};

/// The bytes that a code of `dimension` numbers takes.
constexpr std::size_t code_stride(std::size_t dimension) noexcept {
  return (dimension + 15) / 16 * 16;
}

/// Write codes that lie one after the other with a stride.
///
/// codes   n of `dimension` > 0 bytes each
/// padded  n of code_stride(dimension) bytes each
void pad_codes(std::span<const std::uint8_t> codes, std::size_t dimension,
               std::span<std::uint8_t> padded) noexcept;

/// Write what codes have in their distances to any other: the sum of c (c - 256) over their bytes.
///
/// codes  n of `stride` bytes each
/// norms  n
void code_norms(std::span<const std::uint8_t> codes, std::size_t stride,
                std::span<std::int32_t> norms) noexcept;

/// Write the squared distances of a code q to others: with their norms, |c - q|^2 = norm + |q|^2 -
/// 2 c (q - 128), so that a product of bytes is all that is left to do.
///
/// code     `stride` bytes
/// others   n of them
/// norms    n, by code_norms
/// squared  n
void code_distances(std::span<const std::uint8_t> code, std::span<const std::uint8_t> others,
                    std::span<const std::int32_t> norms, std::span<std::uint32_t> squared) noexcept;

/// Let codes in among the nearest ones so far; of equally near ones the lowest index stays.
///
/// squared  distances of the codes from index `first` on
/// nearest  rising; at least one
void keep_nearest(std::span<const std::uint32_t> squared, std::uint32_t first,
                  std::span<CodeNeighbor> nearest) noexcept;

/// Write the lists that a query is looked for in: those of the nearest centroids, the nearest
/// first.
///
/// norms      num_lists(), of the centroids
/// distances  num_lists(), scratch
/// lists      at least one; as many are searched
void nearest_lists(const CodeIndexView& index, std::span<const std::uint8_t> query,
                   std::span<const std::int32_t> norms, std::span<std::uint32_t> distances,
                   std::span<CodeNeighbor> lists) noexcept;

}  // namespace trivet::kernels
