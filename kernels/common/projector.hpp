/// Fast projection of many vectors onto principal components.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "storage/data/pca_basis.hpp"

namespace trivet::kernels {

/// Principal components as 16-bit integers.
///
/// A vector minus the mean is scaled by a power of two to a length of 2^14 to 2^15 and rounded.
/// Components, whose length is 1, are scaled by 2^15. Sums of products therefore fit into 32 bits
/// (Cauchy and Schwarz) and are exact in any order, so that any vector width gives the same result.
/// Rounding changes a number by some 1e-5 of the vector's length.
class Projector {
 public:
  static constexpr std::size_t kMostNumbers = 1024;  ///< largest dimension

  /// Pre: basis.dimension <= kMostNumbers.
  explicit Projector(const PcaBasis& basis);

  std::size_t dimension() const noexcept { return mean_.size(); }
  /// Number of components.
  std::size_t size() const noexcept { return num_components_; }

  /// Project vectors minus the mean onto the components.
  ///
  /// vectors  n vectors of dimension() finite numbers
  /// out      n vectors of size() numbers
  /// No allocation or lock. Vectors are independent: any split into chunks gives the same bits, on
  /// any processor.
  void project(std::span<const float> vectors, std::span<float> out) const;

 private:
  std::size_t num_components_ = 0;
  std::size_t stride_ = 0;           // size of a component, padded with 0
  Column<float> mean_;               // dimension numbers
  Column<std::int16_t> components_;  // in 2^-15; zero-padded to a whole block
};

}  // namespace trivet::kernels
