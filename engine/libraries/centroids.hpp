/// The centroids of an inverted file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/libraries/code_source.hpp"
#include "storage/common/columns.hpp"

namespace trivet::engine {

/// As many centroids, by Lloyd's iterations over codes spread over the source, of which it reads all
/// once. Takes 64 codes a centroid. Same bytes for any number of threads.
///
/// Returns codes of the source's stride.
Column<std::uint8_t> find_centroids(const CodeSource& codes, std::size_t num_centroids);

/// Codes that all are compared with.
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
  /// Write which is nearest to each of other codes; of equally near ones the first.
  void find_nearest(std::span<const std::uint8_t> others, std::span<std::uint32_t> nearest) const;
  /// Write all squared distances to a code.
  void distances(std::span<const std::uint8_t> code, std::span<std::uint32_t> squared) const;

 private:
  std::size_t stride_ = 0;
  Column<std::uint8_t> codes_;
  Column<std::int32_t> norms_;
};

/// Finds the centroids that codes are nearest to. Up to 2,048 centroids are all compared with each
/// code. More have centers among them, and a code is compared with the centroids about the center that
/// it is nearest to: a time that grows with the root of their number. Of made parts' features 0.4 % stand
/// in another list then, whose centroid is about as near.
class CentroidFinder {
 public:
  CentroidFinder(Column<std::uint8_t> centroids, std::size_t stride);

  /// So many codes are best looked for at a time.
  std::size_t at_once() const noexcept;
  /// Write the nearest centroid of each code, each by itself. From any thread.
  void find(std::span<const std::uint8_t> codes, std::span<std::uint32_t> nearest) const;

 private:
  struct Surroundings {
    std::vector<std::uint32_t> which;  // of the centroids, rising
    ComparedCodes centroids;
  };
  /// The centroids that are nearest to a center.
  static Surroundings surroundings_of(std::span<const std::uint8_t> center, std::size_t count,
                                      const ComparedCodes& centroids);

  std::size_t stride_;
  ComparedCodes centers_;                   // or the centroids, where they are few
  std::vector<Surroundings> surroundings_;  // of each center
};

}  // namespace trivet::engine
