/// Tri-Spin-Images in the basis of a library.
#pragma once

#include <cstdint>
#include <span>

#include "engine/common/describe_surface.hpp"
#include "kernels/common/projector.hpp"
#include "storage/data/tri_spin_features.hpp"

namespace trivet::engine {

/// Features of some keypoints, one after the other.
struct FeatureRows {
  Points keypoints;
  Column<FrameRows> frames;
  Column<std::uint8_t> codes;
};

/// Project images and write them as codes.
FeatureRows encode_features(const Descriptions& descriptions, const kernels::Projector& projector,
                            float code_step);

/// All rows of a model, in their order.
///
/// resolution  that they were described at
TriSpinFeatures join_features(std::span<const FeatureRows> parts, const TriSpinBasis& basis,
                              float resolution);

}  // namespace trivet::engine
