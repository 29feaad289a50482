/// Find the rigid motions that map a model onto itself nearly: poses that differ by one look alike.
#pragma once

#include <optional>
#include <vector>

#include "kernels/surfaces/model_samples.hpp"
#include "kernels/symmetry/turn_screen.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

struct NearSymmetries {
  std::vector<Pose> motions;           ///< best first
  std::optional<Symmetry::Axis> axis;  ///< any turn about it looks alike
};

/// Find turns, with the shifts that fit them best, after which most of the surface lies where the
/// surface was: a screw end for end, a can upside down, a mug turned about its axis.
///
/// samples   n with unit normals; 1000 to 4000 serve well, below 200 nothing is found
/// surface   of all samples
/// screen    of the surface
/// symmetry  of the model; motions count as one where they place the model alike
/// Of motions there are at most 8, turned by 20 degrees and more from the identity and from each
/// other. With each comes its inverse, unless that is the same placement: where pose P has the
/// alternative P * N, the pose P * N has the alternative P. Where there are too many, they are
/// spread farther apart. None is a turn about the axis; there is no axis beside one of the
/// symmetry. Deterministic; of a surface in another frame, the same up to rounding, except for
/// shifts that hardly matter, as of a rod along itself. Pure shifts, as along a thread, are not
/// looked for. Cost: 20 to 60 ms on one core.
///
/// Method: rotations spread evenly over all (Alexa, Super-Fibonacci spirals, CVPR 2022) are rated
/// about the centroid on a coarse distance field; the best of each bundle are shifted, then refined
/// point to plane. What counts is the share of samples that come within 2 % of the diameter of the
/// surface with agreeing normals: of those seen by the quarter of all views that keep most, 65 %
/// must, and 45 % of all. So a motion counts that looks alike from one side only. And no turn by 15
/// degrees beside it may look more alike: it is a minimum of the misfit. For the axis, the
/// principal axes and those of the symmetry's turns are refined, unless few samples refute them; ten
/// turns about it must
/// keep 72 % of all samples.
NearSymmetries find_near_symmetries(const ModelSamples& samples, const SampledSurface& surface,
                                    const TurnScreen& screen, const Symmetry& symmetry);

}  // namespace trivet::kernels
