/// Models of a library that look like another one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/symmetry/align_shapes.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Where another model lies when it looks like this one.
struct LookAlike {
  std::uint32_t model = 0;  ///< of the library
  Pose T_model_other = Pose::Identity();
};

/// By model of the library, whose samples are checked all. Errors: bad_data (the samples of a model are damaged).
Result<std::vector<kernels::ShapeFrame>> shape_frames(const Library& library);

/// Of the models that are spread most alike, those whose surface comes near that of a model, turned
/// as kernels::ShapeAligner tries; one may come twice. The alikest come first, at most forty.
///
/// frames  as shape_frames gives them
/// Same bytes for any number of threads.
std::vector<LookAlike> find_look_alikes(const Library& library,
                                        std::span<const kernels::ShapeFrame> frames,
                                        std::uint32_t model);

}  // namespace trivet::engine
