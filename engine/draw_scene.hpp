/// Pictures of a scene and of models in it, for people to judge.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/recognise.hpp"
#include "storage/cloud.hpp"
#include "storage/model.hpp"
#include "storage/result.hpp"
#include "storage/write_png.hpp"

namespace trivet {

struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;
};

/// A model to draw where it is believed to be.
struct Overlay {
  const Model* model = nullptr;
  Pose T_scene_model;  ///< in the scene file's unit
  Colour outline;
  Colour surface;
  bool filled = true;  ///< else the outline only
};

/// The part of the picture that an overlay takes up, from 0 (left, top) to 1; left > right where it
/// is not seen.
struct DrawnBox {
  float left = 1, top = 1, right = 0, bottom = 0;
};

struct ScenePictures {
  Picture scan;  ///< the measured surface in grey, lit from above the sensor; dark: no measurement
  Picture
      overlaid;  ///< the same with the models drawn in; paler where the scan is in front of them
  std::vector<DrawnBox> boxes;  ///< one an overlay
};

/// Draw a scene as its sensor saw it; a closed surface as the side with most to be seen.
///
/// overlays  filled ones hide one another by depth; those that are not filled are drawn over all
/// Errors: bad_data (too few points, no surface), internal (ray tracing).
Result<ScenePictures> draw_scene(const Cloud& cloud, const SceneInput& input,
                                 std::span<const Overlay> overlays);

}  // namespace trivet
