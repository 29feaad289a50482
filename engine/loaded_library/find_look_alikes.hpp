/// Models of a library that look like another model.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/symmetry/align_shapes.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Pose of another model that looks like this one.
struct LookAlike {
  std::uint32_t model = 0;  ///< index in the library
  Pose T_model_other = Pose::Identity();
};

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

}  // namespace trivet::engine
