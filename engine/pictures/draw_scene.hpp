/// Pictures of a scene and of the models in it, for visual inspection.
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

/// A model to draw in its estimated pose. Its lengths are in the unit that the scene is scaled to
/// (SceneInput::scale).
struct Overlay {
  const EvaluationMesh* mesh = nullptr;
  FilePose T_scene_model;
  Color outline;
  Color surface;
  bool filled = true;  ///< whether to fill it; otherwise only the outline is drawn
};

/// The box of an overlay in the picture, from 0 (left, top) to 1; left > right if it is not
/// visible.
struct DrawnBox {
  float left = 1, top = 1, right = 0, bottom = 0;
  /// Position for a label: the place farthest from anything that is not this overlay or occludes
  /// it; if everything is occluded, the center of the box.
  float label_x = 0, label_y = 0;
};

struct ScenePictures {
  Picture scan;  ///< measured surface in gray, lit from above the sensor; dark: no measurement
  /// The same picture with the models drawn in, paler where the scan occludes them.
  Picture overlaid;
  std::vector<DrawnBox> boxes;  ///< one per overlay
};

/// A scene prepared for drawing, as its sensor saw it; a closed surface is seen from the side with
/// most measurements. Meshes are prepared once and must not move during its lifetime. Not
/// thread-safe.
class SceneDrawing {
 public:
  /// largest_diameter  diameter of the largest model; planes too large to be part of a model are
  ///                   drawn darker
  /// Errors: bad_data (too few points, no surface).
  static Result<SceneDrawing> prepare(const Cloud& cloud, const SceneInput& input,
                                      float largest_diameter);
  SceneDrawing(SceneDrawing&&) noexcept;
  SceneDrawing& operator=(SceneDrawing&&) noexcept;
  ~SceneDrawing();

  /// Draw the whole scene, 640 to 1,024 pixels wide. Filled overlays occlude one another by depth;
  /// outlines are drawn over everything, in their order.
  /// Errors: internal (ray tracing).
  Result<ScenePictures> draw(std::span<const Overlay> overlays);

  /// Draw a square around some models and their surroundings, 360 to 720 pixels wide, with these
  /// overlays.
  /// Errors: bad_data (all models lie behind the sensor), internal (ray tracing).
  Result<ScenePictures> draw_around(std::span<const Overlay> models,
                                    std::span<const Overlay> overlays);

 private:
  struct State;
  explicit SceneDrawing(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace trivet
