/// The principal components of Tri-Spin-Images.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/training/train.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/tri_spin_features.hpp"

namespace trivet::engine {

/// Concatenated images of a sample of a model's keypoints, spread over all of them and all scales,
/// at most `wanted`. Errors: as for training.
Result<std::vector<float>> sample_images(const Cloud& cloud, const ModelSource& source,
                                         std::size_t wanted);

/// The basis of images; empty without images.
TriSpinBasis basis_of(std::span<const float> images, std::size_t num_components);

}  // namespace trivet::engine
