/// Nearest neighbors among the byte codes of millions of features.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace trivet::kernels {

/// An inverted file: each code is in the list of its nearest centroid, and a query is compared with
/// the codes of a few lists. Squared distances are whole numbers, so exact: any processor and any
/// order of comparisons gives the same bits.
///
/// A code has `stride` bytes, a multiple of 16, zero-padded.
/// Source: Sivic, Zisserman, ICCV 2003; Jegou, Douze, Schmid, PAMI 2011, section IV.
struct CodeIndexView {
  std::size_t stride = 0;
  std::span<const std::uint8_t> centroids;  ///< one centroid per list
  std::span<const std::uint32_t> offsets;   ///< start of each list, and the end of the last
  std::span<const std::uint8_t> codes;      ///< codes, list by list

  std::size_t num_lists() const noexcept { return offsets.empty() ? 0 : offsets.size() - 1; }
  std::size_t size() const noexcept { return offsets.empty() ? 0 : offsets.back(); }
};

struct CodeNeighbor {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t squared = kNone;  ///< squared distance, in steps of the code
  std::uint32_t index = kNone;    ///< index of the code; kNone: there is no neighbor
  auto operator<=>(const CodeNeighbor&) const = default;
};

/// Bytes of a code of `dimension` numbers.
constexpr std::size_t code_stride(std::size_t dimension) noexcept {
  return (dimension + 15) / 16 * 16;
}

/// Copy contiguous codes to a layout with a stride.
///
/// codes   n codes of `dimension` > 0 bytes each
/// padded  n codes of code_stride(dimension) bytes each
void pad_codes(std::span<const std::uint8_t> codes, std::size_t dimension,
               std::span<std::uint8_t> padded) noexcept;

/// Compute the part of the distance to any other code that depends on one code only: the sum of c
/// (c - 256) over its bytes.
///
/// codes  n codes of `stride` bytes each
/// norms  n
void code_norms(std::span<const std::uint8_t> codes, std::size_t stride,
                std::span<std::int32_t> norms) noexcept;

/// Compute the squared distances of a code q to others. With their norms, |c - q|^2 = norm + |q|^2
/// - 2 c (q - 128), so only a dot product of bytes remains.
///
/// code     `stride` bytes
/// others   n codes
/// norms    n, from code_norms
/// squared  n
void code_distances(std::span<const std::uint8_t> code, std::span<const std::uint8_t> others,
                    std::span<const std::int32_t> norms, std::span<std::uint32_t> squared) noexcept;

/// Insert codes into the list of nearest ones so far; ties keep the lowest index.
///
/// squared  distances of the codes from index `first` on
/// nearest  ascending; at least one
void keep_nearest(std::span<const std::uint32_t> squared, std::uint32_t first,
                  std::span<CodeNeighbor> nearest) noexcept;

/// Find the lists to search for a query: those of the nearest centroids, the nearest first.
///
/// norms      num_lists() norms of the centroids
/// distances  num_lists(), scratch
/// lists      output; its size, at least one, is the number of lists to search
void nearest_lists(const CodeIndexView& index, std::span<const std::uint8_t> query,
                   std::span<const std::int32_t> norms, std::span<std::uint32_t> distances,
                   std::span<CodeNeighbor> lists) noexcept;

}  // namespace trivet::kernels
