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

/// Images of some of a model's keypoints, spread over all and over all scales: at most `wanted`, one
/// after the other. Errors: as of training.
Result<std::vector<float>> sample_images(const Cloud& cloud, const ModelSource& source,
                                         std::size_t wanted);

/// The basis of images; without any, an empty one.
TriSpinBasis basis_of(std::span<const float> images, std::size_t num_components);

}  // namespace trivet::engine
