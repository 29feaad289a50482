/// Whether two poses of a model are the same placement.
#pragma once

#include <numbers>

#include "storage/data/model.hpp"

namespace trivet::engine {

/// Limits within which a pose is correct [diameters], [rad].
inline constexpr float kRightTranslation = 0.1F;
inline constexpr float kRightRotationRad = 12 * std::numbers::pi_v<float> / 180;

/// Whether two poses of a model are the same placement, that is, within the limits of a correct
/// detection, modulo symmetry.
/// Source: Drost et al., CVPR 2010, section 5.
bool same_placement(const ModelInfo& model, const Pose& a, const Pose& b) noexcept;

}  // namespace trivet::engine
