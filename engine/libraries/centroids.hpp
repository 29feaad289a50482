/// The centroids of an inverted file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/libraries/code_source.hpp"
#include "storage/common/columns.hpp"

namespace trivet::engine {

/// Find centroids by Lloyd's iterations over codes sampled evenly from the source, all of which are
/// read once. Uses 64 codes per centroid. Same bytes for any number of threads.
///
/// Returns codes with the source's stride.
Column<std::uint8_t> find_centroids(const CodeSource& codes, std::size_t num_centroids);

/// A set of codes that queries are compared with exhaustively.
class ComparedCodes {
 public:
  ComparedCodes() = default;
  ComparedCodes(Column<std::uint8_t> codes, std::size_t stride);

  std::size_t size() const noexcept { return norms_.size(); }
  std::size_t stride() const noexcept { return stride_; }
  std::span<const std::uint8_t> codes() const noexcept { return codes_; }
  std::span<const std::uint8_t> operator[](std::size_t i) const {
    return std::span(codes_).subspan(i * stride_, stride_);
  }
  /// Write the index of the nearest code for each query; for ties the first.
  void find_nearest(std::span<const std::uint8_t> others, std::span<std::uint32_t> nearest) const;
  /// Write the squared distances of all codes to a query.
  void distances(std::span<const std::uint8_t> code, std::span<std::uint32_t> squared) const;

 private:
  std::size_t stride_ = 0;
  Column<std::uint8_t> codes_;
  Column<std::int32_t> norms_;
};

/// Finds the nearest centroids of codes. Up to 2,048 centroids are compared with each code
/// exhaustively. Larger sets use centers among the centroids: a code is compared with the centroids
/// around its nearest center, so that the time grows with the square root of their number. This
/// assigns 0.4 % of the generated parts' features to another list, whose centroid is about as near.
class CentroidFinder {
 public:
  CentroidFinder(Column<std::uint8_t> centroids, std::size_t stride);

  /// Recommended number of codes per call.
  std::size_t at_once() const noexcept;
  /// Write the nearest centroid of each code; codes are independent. Thread-safe.
  void find(std::span<const std::uint8_t> codes, std::span<std::uint32_t> nearest) const;

 private:
  struct Surroundings {
    std::vector<std::uint32_t> which;  // indices of the centroids, rising
    ComparedCodes centroids;
  };
  /// The centroids nearest to a center.
  static Surroundings surroundings_of(std::span<const std::uint8_t> center, std::size_t count,
                                      const ComparedCodes& centroids);

  std::size_t stride_;
  ComparedCodes centers_;                   // or all centroids, if they are few
  std::vector<Surroundings> surroundings_;  // one per center
};

}  // namespace trivet::engine
