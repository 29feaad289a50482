/// Turns about a line.
#pragma once

#include <span>

#include "kernels/symmetry/sampled_surface.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Turn by `angle` about the axis [rad].
Pose turn_about(const Symmetry::Axis& axis, float angle) noexcept;

/// The line that a motion turns about; its shift along the line is left out. Pre: it turns.
Symmetry::Axis axis_of(const Pose& motion) noexcept;

/// The axis that turns about it see after refinement on the surface: their mean. All is in the
/// surface's own frame.
Symmetry::Axis refine_axis(const SampledSurface& surface, const Symmetry::Axis& axis,
                           std::span<const float> angles) noexcept;

}  // namespace trivet::kernels
