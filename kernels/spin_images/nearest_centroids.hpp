/// Assignment of codes to the centroids of an inverted file, and k-means updates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace trivet::kernels {

/// Find the nearest centroid of each code by squared distance; ties keep the first.
///
/// codes      n codes of `stride` bytes each (code_stride)
/// centroids  at least one, in the same layout
/// norms      one per centroid, from code_norms
/// nearest    n
void nearest_centroids(std::span<const std::uint8_t> codes, std::size_t stride,
                       std::span<const std::uint8_t> centroids, std::span<const std::int32_t> norms,
                       std::span<std::uint32_t> nearest) noexcept;

/// Sums of the codes nearest to each centroid, from which the next centroids follow.
struct CentroidSums {
  CentroidSums(std::size_t num_lists, std::size_t stride)
      : sums(num_lists * stride, 0), counts(num_lists, 0) {}
  std::vector<std::uint64_t> sums;
  std::vector<std::uint32_t> counts;
};

/// Add each code to the sums of its nearest centroid. Integers: any order gives the same result.
///
/// codes    n codes of `stride` bytes each
/// nearest  n
void add_to_centroids(std::span<const std::uint8_t> codes, std::size_t stride,
                      std::span<const std::uint32_t> nearest, CentroidSums& sums) noexcept;

/// Move each centroid to the mean of its codes; centroids without codes stay.
void move_centroids(const CentroidSums& sums, std::span<std::uint8_t> centroids) noexcept;

}  // namespace trivet::kernels
