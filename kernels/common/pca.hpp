/// Principal components of many vectors.
#pragma once

#include <cstddef>
#include <span>

#include "storage/data/pca_basis.hpp"

namespace trivet::kernels {

/// Compute the mean and the principal components.
///
/// vectors         n vectors of `dimension` > 0 finite numbers, concatenated; n >= 1
/// max_components  > 0; fewer result if there are fewer dimensions, or by `energy`
/// energy          0..1: components beyond this share of the variance are omitted
/// The largest number of each component is positive. Deterministic. Allocates dimension^2 doubles.
/// Cost: n dimension^2.
/// Source: Pearson 1901; eigenvectors of the covariance.
PcaBasis find_components(std::span<const float> vectors, std::size_t dimension,
                         std::size_t max_components, double energy = 1);

}  // namespace trivet::kernels
