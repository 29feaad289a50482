/// Rotations about an axis.
#pragma once

#include <span>

#include "kernels/symmetry/sampled_surface.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Rotation by `angle` [rad] about the axis.
Pose turn_about(const Symmetry::Axis& axis, float angle) noexcept;

/// The rotation axis of a transform; its shift along the axis is ignored. Pre: it rotates.
Symmetry::Axis axis_of(const Pose& motion) noexcept;

/// Refine an axis: rotations about it are refined on the surface, and their axes averaged. All is
/// in the surface's normalized frame.
Symmetry::Axis refine_axis(const SampledSurface& surface, const Symmetry::Axis& axis,
                           std::span<const float> angles) noexcept;

}  // namespace trivet::kernels
