/// Tri-Spin-Images in the basis of a library.
#pragma once

#include <span>
#include <vector>

#include "engine/training/describe_surface.hpp"
#include "storage/tri_spin_features.hpp"

namespace trivet::engine {

/// Project images and write them as codes. Same bytes for any number of threads.
///
/// resolution  distance between the points that were described
TriSpinFeatures encode_features(const Descriptions& descriptions, const TriSpinBasis& basis,
                                float resolution);

}  // namespace trivet::engine
