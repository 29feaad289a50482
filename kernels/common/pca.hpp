/// Principal components of many vectors.
#pragma once

#include <cstddef>
#include <span>

#include "storage/data/pca_basis.hpp"

namespace trivet::kernels {

/// Find mean and principal components.
///
/// vectors         n of `dimension` > 0 finite numbers, one after the other; n >= 1
/// max_components  > 0; less than that where there are fewer dimensions, or where
/// energy          0..1: components that together keep this share of the variance are enough
/// The largest number of each component is positive. Deterministic. Takes dimension^2 doubles.
/// Cost: n dimension^2.
/// Source: Pearson 1901; eigenvectors of the covariance.
PcaBasis find_components(std::span<const float> vectors, std::size_t dimension,
                         std::size_t max_components, double energy = 1);

}  // namespace trivet::kernels
