/// Pictures of a scene and of models in it, for people to judge.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/evaluation/evaluation_meshes.hpp"
#include "engine/scene/read_scene.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/formats/write_png.hpp"

namespace trivet {

struct Color {
  std::uint8_t red = 0, green = 0, blue = 0;
};

/// A model to draw where it is believed to be. Its lengths are in the unit that the scene is scaled
/// to (SceneInput::scale).
struct Overlay {
  const EvaluationMesh* mesh = nullptr;
  FilePose T_scene_model;
  Color outline;
  Color surface;
  bool filled = true;  ///< else the outline only
};

/// The part of the picture that an overlay takes up, from 0 (left, top) to 1; left > right where it
/// is not seen.
struct DrawnBox {
  float left = 1, top = 1, right = 0, bottom = 0;
  /// Where a label lies on it: the place farthest from whatever is not this overlay or hides it;
  /// where everything is hidden, the middle of the box.
  float label_x = 0, label_y = 0;
};

struct ScenePictures {
  Picture scan;  ///< the measured surface in gray, lit from above the sensor; dark: no measurement
  /// The same with the models drawn in; paler where the scan is in front of them.
  Picture overlaid;
  std::vector<DrawnBox> boxes;  ///< one an overlay
};

/// A scene made ready to be drawn, as its sensor saw it; a closed surface as the side with most to
/// be seen. Meshes must stay in place while it lives: they are prepared once. Not for use by two
/// threads at once.
class SceneDrawing {
 public:
  /// largest_diameter  of the models; planes too large to be part of one are drawn darker
  /// Errors: bad_data (too few points, no surface).
  static Result<SceneDrawing> prepare(const Cloud& cloud, const SceneInput& input,
                                      float largest_diameter);
  SceneDrawing(SceneDrawing&&) noexcept;
  SceneDrawing& operator=(SceneDrawing&&) noexcept;
  ~SceneDrawing();

  /// The whole scene, 640 to 1,024 pixels wide. Filled overlays hide one another by depth; those
  /// that are not filled are drawn over all, in their order.
  /// Errors: internal (ray tracing).
  Result<ScenePictures> draw(std::span<const Overlay> overlays);

  /// A square around some models with some of what surrounds them, 360 to 720 pixels wide, and
  /// these overlays in it.
  /// Errors: bad_data (all models lie behind the sensor), internal (ray tracing).
  Result<ScenePictures> draw_around(std::span<const Overlay> models,
                                    std::span<const Overlay> overlays);

 private:
  struct State;
  explicit SceneDrawing(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace trivet
