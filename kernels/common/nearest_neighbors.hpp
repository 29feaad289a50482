/// Exact nearest neighbors among vectors of any dimension.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "storage/common/columns.hpp"
#include "storage/common/result.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// A k-d tree over points or feature vectors, by FLANN, immutable once it is built.
///
/// Vectors and queries of d dimensions are concatenated: vector i is the d floats from i * d on.
/// All searches are exact, include the radius, and break ties by the lowest index, so that any
/// split of the queries gives the same bits. Searches are thread-safe; FLANN allocates d floats for
/// each query. For points in space and a radius known beforehand, VoxelHash is faster. Source:
/// Friedman, Bentley, Finkel, ACM TOMS 1977 (k-d tree); Muja and Lowe, VISAPP 2009 (FLANN).
class NearestNeighbors {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// Build over n vectors, n < 2^31. Keeps a copy of them.
  /// Errors: bad_data (a value is not finite, or the length is not a multiple of the dimension),
  /// no_memory.
  static Result<NearestNeighbors> build(std::span<const float> vectors, std::size_t dimension);
  static Result<NearestNeighbors> build(PointsView points);

  NearestNeighbors(NearestNeighbors&&) noexcept;
  NearestNeighbors& operator=(NearestNeighbors&&) noexcept;
  ~NearestNeighbors();

  std::size_t size() const noexcept;
  std::size_t dimension() const noexcept;

  /// Write the k nearest vectors of each query, the nearest first.
  ///
  /// queries            m vectors; non-finite ones have no neighbors
  /// indices            m * k; kNone past the last neighbor
  /// squared_distances  m * k; infinite past the last neighbor
  /// Errors: no_memory.
  Result<void> k_nearest(std::span<const float> queries, std::size_t k,
                         std::span<std::uint32_t> indices,
                         std::span<float> squared_distances) const;
  Result<void> k_nearest(PointsView queries, std::size_t k, std::span<std::uint32_t> indices,
                         std::span<float> squared_distances) const;

  /// Count the vectors within radius of each query. Errors: no_memory.
  Result<void> count_within(std::span<const float> queries, float radius,
                            std::span<std::uint32_t> counts) const;

  /// Write the vectors within radius of each query, in ascending order of index.
  ///
  /// offsets  m + 1, exclusive sums of the counts; row i goes to indices[offsets[i] .. offsets[i +
  ///          1])
  /// Errors: no_memory.
  Result<void> fill_within(std::span<const float> queries, float radius,
                           std::span<const std::uint32_t> offsets,
                           std::span<std::uint32_t> indices) const;

 private:
  struct Index;
  explicit NearestNeighbors(std::unique_ptr<Index> index) noexcept;
  std::unique_ptr<Index> index_;
};

}  // namespace trivet::kernels
