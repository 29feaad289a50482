/// Kind and viewpoint of a scene.
#pragma once

#include <optional>

#include "engine/results/scene_view.hpp"
#include "engine/scene/read_scene.hpp"
#include "kernels/scans/range_image.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"

namespace trivet::engine {

/// The view of a scene.
struct FoundView {
  SceneView view{};
  /// Pixel geometry of a scan without a camera, as its grid or the rays of its points determine it;
  /// in the cloud's frame and unit.
  std::optional<kernels::ImageGeometry> geometry{};
};

/// Determine the view from the caller and the file. If they give none and there are triangles, it
/// follows from visibility. A surface that turns one side to the origin was seen from there. A
/// surface whose faces point to a far place and turn their fronts to it was seen from that place.
/// Any other surface with almost no border is a whole surface. In all other cases the origin is
/// assumed.
///
/// Rows and columns of an organized scan determine the view if neither caller nor file does, and
/// rays through the pixels of an image confirm the origin.
/// Writers that know no viewpoint write the origin, so that a file's origin counts as none.
///
/// Errors: bad_data (a viewpoint that is too far from the points for floats).
Result<FoundView> find_view(const Cloud& cloud, const SceneInput& input);

}  // namespace trivet::engine
