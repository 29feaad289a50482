/// Models of a library that look like another model.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/symmetry/align_shapes.hpp"
#include "kernels/symmetry/refine_alignment.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Pose of another model that looks like this one.
struct LookAlike {
  std::uint32_t model = 0;  ///< index in the library
  Pose T_model_other = Pose::Identity();
};

/// Smallest share of the samples of two models that lie on each other's surface if most of their
/// surfaces coincide: what they have in common then holds one on the other.
inline constexpr float kCoinciding = 0.5F;
/// Distance of surfaces that coincide. It is half the tolerance of verification, from which on
/// kernels::compare_poses takes two surfaces for different.
constexpr float coinciding_distance(float diameter) noexcept { return 0.008F * diameter; }

/// Shape frames by model of the library. Errors: bad_data (the samples of a model are damaged).
Result<std::vector<kernels::ShapeFrame>> shape_frames(const Library& library);

/// Find models whose surface comes near this model's surface, among those with the most similar
/// spread. They are turned as kernels::ShapeAligner tries; a model may occur twice. The most
/// similar ones come first, at most forty.
///
/// frames  as returned by shape_frames
/// Same bytes for any number of threads. Errors: as for shape_frames.
Result<std::vector<LookAlike>> find_look_alikes(const Library& library,
                                                std::span<const kernels::ShapeFrame> frames,
                                                std::uint32_t model);

/// A look-alike most of whose surface coincides with this model's.
struct NearCopy {
  std::uint32_t model = 0;                ///< index in the library
  Pose T_model_other = Pose::Identity();  ///< refined, so that what they have in common coincides
  float agreeing = 0;                     ///< see kernels::RefinedAlignment
};

/// The look-alikes of a model that are near copies of it, those that agree most first; a model may
/// occur twice. Ties keep the order of the look-alikes.
/// Same bytes for any number of threads. Errors: as for shape_frames.
Result<std::vector<NearCopy>> find_near_copies(const Library& library,
                                               std::span<const LookAlike> look_alikes,
                                               std::uint32_t model);

}  // namespace trivet::engine
