/// Smooth random fields over an image with a given correlation length.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace trivet::kernels {

/// A field of mean 0 and mean square 1 that is smooth over `length_pixel`.
///
/// Independent normal numbers on a lattice of `length_pixel` / 2, interpolated by cubic B-splines:
/// the autocorrelation falls to a half at half a length and to 0.05 at a length. Depends on (seed,
/// stream, item) and the pixel alone. Construction allocates; evaluation does not.
class NoiseField {
 public:
  /// length_pixel >= 2
  NoiseField(std::uint32_t width, std::uint32_t height, double length_pixel, std::uint64_t seed,
             std::uint64_t stream, std::uint64_t first_item);
  double at(double u, double v) const noexcept;

 private:
  double spacing_;
  std::size_t columns_;
  std::vector<float> knots_;
};

}  // namespace trivet::kernels
