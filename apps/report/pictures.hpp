/// Common parts of the pictures of all reports: opening of scenes, colors, labels, and storage of
/// pictures.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/pictures/draw_scene.hpp"

namespace trivet::apps {

/// The approximate size of an embedded picture of a whole scene, and the maximum size of a page
/// [byte].
inline constexpr std::size_t kPictureBytes = 325'000, kMaxPageBytes = 20'000'000;

/// Storage of the pictures of a report: in the page, in files beside it, or both.
class PictureStore {
 public:
  struct Places {
    bool within_page = true, as_files = false;
  };
  /// folder  of the report; files are written to folder/pictures
  PictureStore(std::filesystem::path folder, const Places& places)
      : folder_(std::move(folder)), places_(places) {}
  /// Stores a picture and returns its <img>. `name` is that of its file, without extension; `text`
  /// describes it. Errors: those of writing.
  Result<std::string> add(const Picture& picture, const std::string& name, std::string_view text);

 private:
  std::filesystem::path folder_;
  Places places_;
};

/// Reads a scene and prepares it for drawing with these models.
/// Errors: those of reading and of SceneDrawing::prepare.
Result<SceneDrawing> open_scene(const SceneInput& scene, std::span<const EvaluationMesh> models);

std::string css(const Color& color);

/// A model's color in pictures and tables. `mesh` is one of `meshes`.
Color model_color(std::span<const EvaluationMesh> meshes, const EvaluationMesh& mesh);

/// A model's name after a small square of its color; the name alone if there is no such mesh.
std::string model_label(std::span<const EvaluationMesh> meshes, const std::string& name);

/// A text above a picture, underlined in a color.
struct PictureLabel {
  Color color;
  std::string text;  ///< plain text
};

/// Labels for the visible parts of the boxes, one per box. An empty text or a box without visible
/// part has none. A label that would cover an earlier one is placed below it.
std::string picture_labels(std::span<const PictureLabel> labels, std::span<const DrawnBox> boxes);

/// One of several pictures of the same view.
struct ViewLayer {
  std::string name;     ///< plain text
  std::string content;  ///< HTML: the picture and its labels
};

/// A view that shows one of its layers at a time, `shown` at first: the reader selects. `id` is
/// unique on the page.
std::string layered_view(const std::string& id, std::span<const ViewLayer> layers,
                         std::size_t shown);

}  // namespace trivet::apps
