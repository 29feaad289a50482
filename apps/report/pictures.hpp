/// What the pictures of all reports share: how scenes are opened, colors, labels, and where the
/// pictures go.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/pictures/draw_scene.hpp"

namespace trivet::apps {

/// What a picture of a whole scene takes within a page, about, and how large a page should get
/// [byte].
inline constexpr std::size_t kPictureBytes = 325'000, kMaxPageBytes = 20'000'000;

/// Where the pictures of a report go: into the page, into files beside it, or both.
class PictureStore {
 public:
  struct Places {
    bool within_page = true, as_files = false;
  };
  /// folder  of the report; files go to folder/pictures
  PictureStore(std::filesystem::path folder, const Places& places)
      : folder_(std::move(folder)), places_(places) {}
  /// An <img> of the picture. `name` is that of its file, without extension; `text` describes it.
  /// Errors: those of writing.
  Result<std::string> add(const Picture& picture, const std::string& name, std::string_view text);

 private:
  std::filesystem::path folder_;
  Places places_;
};

/// Read a scene and make it ready to be drawn with these models. Errors: those of reading and of
/// SceneDrawing::prepare.
Result<SceneDrawing> open_scene(const SceneInput& scene, std::span<const EvaluationMesh> models);

std::string css(const Color& color);

/// A model's color in pictures and tables. `mesh` is one of `meshes`.
Color model_color(std::span<const EvaluationMesh> meshes, const EvaluationMesh& mesh);

/// A model's name after a small square of its color; the name alone where there is no such mesh.
std::string model_label(std::span<const EvaluationMesh> meshes, const std::string& name);

/// A text above a picture, underlined in a color.
struct PictureLabel {
  Color color;
  std::string text;  ///< plain
};

/// Labels on what is seen in the boxes, one a box; none for an empty text, or where nothing is seen.
/// One that would cover an earlier one stands below it.
std::string picture_labels(std::span<const PictureLabel> labels, std::span<const DrawnBox> boxes);

/// One of several pictures of the same view.
struct ViewLayer {
  std::string name;     ///< plain
  std::string content;  ///< HTML: the picture and its labels
};

/// A view that shows one of its layers at a time, `shown` at first: the reader picks. `id` is like no
/// other on the page.
std::string layered_view(const std::string& id, std::span<const ViewLayer> layers,
                         std::size_t shown);

}  // namespace trivet::apps
