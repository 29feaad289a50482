/// Vectors in terms of principal components, many and fast.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "storage/data/pca_basis.hpp"

namespace trivet::kernels {

/// Principal components as whole numbers of 16 bits.
///
/// A vector less the mean is scaled by a power of two, to a length of 2^14 to 2^15, and rounded;
/// components, whose length is 1, by 2^15. No sum of products can then leave 32 bits (Cauchy and
/// Schwarz), and sums are exact: the same in any order, so that a processor may add up as many at a
/// time as it can. Rounding moves a number by some 1e-5 of the vector's length.
class Projector {
 public:
  static constexpr std::size_t kMostNumbers = 1024;  ///< of a vector

  /// Pre: basis.dimension <= kMostNumbers.
  explicit Projector(const PcaBasis& basis);

  std::size_t dimension() const noexcept { return mean_.size(); }
  /// Number of components.
  std::size_t size() const noexcept { return num_components_; }

  /// Write vectors less the mean in terms of the components.
  ///
  /// vectors  n of dimension() finite numbers
  /// out      n of size() numbers
  /// No allocation or lock. Vectors are independent: any split into chunks gives the same
  /// bits, on any processor.
  void project(std::span<const float> vectors, std::span<float> out) const;

 private:
  std::size_t num_components_ = 0;
  std::size_t stride_ = 0;           // of a component: filled up with 0
  Column<float> mean_;               // dimension numbers
  Column<std::int16_t> components_;  // in 2^-15; zeros behind the last, up to a whole block
};

}  // namespace trivet::kernels
