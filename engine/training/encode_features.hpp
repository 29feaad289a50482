/// Tri-Spin-Images projected onto the basis of a library.
#pragma once

#include <cstdint>
#include <span>

#include "engine/common/describe_surface.hpp"
#include "kernels/common/projector.hpp"
#include "storage/data/tri_spin_features.hpp"

namespace trivet::engine {

/// Concatenated features of some keypoints.
struct FeatureRows {
  Points keypoints;
  Column<FrameRows> frames;
  Column<std::uint8_t> codes;
};

/// Project images and write them as codes.
FeatureRows encode_features(const Descriptions& descriptions, const kernels::Projector& projector,
                            float code_step);

/// Concatenate all rows of a model.
///
/// resolution  resolution of the descriptions
TriSpinFeatures join_features(std::span<const FeatureRows> parts, const TriSpinBasis& basis,
                              float resolution);

}  // namespace trivet::engine
