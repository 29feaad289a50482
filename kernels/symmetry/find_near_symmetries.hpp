/// Search for near symmetries: rigid transforms that map a model nearly onto itself, so that poses
/// that differ by one look alike.
#pragma once

#include <optional>
#include <vector>

#include "kernels/surfaces/model_samples.hpp"
#include "kernels/symmetry/turn_screen.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

struct NearSymmetries {
  std::vector<Pose> motions;           ///< best first
  std::optional<Symmetry::Axis> axis;  ///< axis about which any rotation looks alike
};

/// Find rotations, with their best-fitting shifts, that move most of the surface onto the original
/// surface: a screw end for end, a can upside down, a mug rotated about its axis.
///
/// samples   n with unit normals; 1000 to 4000 serve well, below 200 nothing is found
/// surface   surface of all samples
/// screen    screen of the surface
/// symmetry  symmetry of the model; transforms that place the model alike count as one
/// There are at most 8 transforms, rotated by 20 degrees and more from the identity and from each
/// other. Each is listed with its inverse, unless that is the same placement: if pose P has the
/// alternative P * N, the pose P * N has the alternative P. If there are too many, a larger
/// separation is used. None is a rotation about the axis; there is no axis beside one of the
/// symmetry. Deterministic. For a surface in another frame, the result is the same up to rounding,
/// except for shifts that hardly matter, as of a rod along itself. Pure shifts, as along a thread,
/// are not searched. Cost: 20 to 60 ms on one core.
///
/// Method: rotations spread evenly over all (Alexa, Super-Fibonacci spirals, CVPR 2022) are rated
/// about the centroid on a coarse distance field; the best of each bundle are shifted, then refined
/// point to plane. The criterion is the share of samples that come within 2 % of the diameter of
/// the surface with agreeing normals. It must be 65 % of the samples visible in the quarter of all
/// views that keep most, and 45 % of all samples. So a transform counts that looks alike from one
/// side only. No rotation by 15 degrees beside it may look more alike: it is a minimum of the
/// misfit. For the axis, the principal axes and those of the symmetry's rotations are refined,
/// unless few samples refute them; ten rotations about it must keep 72 % of all samples.
NearSymmetries find_near_symmetries(const ModelSamples& samples, const SampledSurface& surface,
                                    const TurnScreen& screen, const Symmetry& symmetry);

}  // namespace trivet::kernels
