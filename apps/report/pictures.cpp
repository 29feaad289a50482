#include "apps/report/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/html.hpp"
#include "storage/files/file.hpp"

namespace trivet::apps {
namespace {

/// Distinguishable by eye, and different from the outlines.
constexpr std::array<Color, 10> kModelColors{{{236, 168, 62},
                                              {158, 118, 226},
                                              {62, 178, 178},
                                              {232, 124, 174},
                                              {178, 178, 74},
                                              {212, 116, 84},
                                              {120, 166, 216},
                                              {196, 150, 110},
                                              {200, 160, 222},
                                              {130, 190, 150}}};

}  // namespace

Result<std::string> PictureStore::add(const Picture& picture, const std::string& name,
                                      std::string_view text) {
  const Result<std::vector<std::byte>> png = encode_png(picture);
  if (!png) return png.error();
  std::string address = "pictures/" + name + ".png";
  if (places_.as_files) {
    TRIVET_TRY(make_folder(folder_ / "pictures"));
    TRIVET_TRY(publish_file(folder_ / address, *png));
  }
  if (places_.within_page) address = png_address(*png);
  return fmt::format("<img loading=\"lazy\" width=\"{}\" height=\"{}\" alt=\"{}\" src=\"{}\">",
                     picture.width, picture.height, escape_html(text), address);
}

Result<SceneDrawing> open_scene(const SceneInput& scene, std::span<const EvaluationMesh> models) {
  double largest = 0;
  for (const EvaluationMesh& model : models) largest = std::max(largest, model.diameter);
  const Result<Cloud> cloud = read_scene(scene);
  if (!cloud) return cloud.error();
  return SceneDrawing::prepare(*cloud, scene, static_cast<float>(largest));
}

std::string css(const Color& color) {
  return fmt::format("rgb({},{},{})", color.red, color.green, color.blue);
}

/// The palette, then a paler one, and so on.
Color model_color(std::span<const EvaluationMesh> meshes, const EvaluationMesh& mesh) {
  const auto index = static_cast<std::size_t>(&mesh - meshes.data());
  Color color = kModelColors[index % kModelColors.size()];
  for (std::size_t round = 0; round < index / kModelColors.size() % 3; ++round) {
    for (std::uint8_t* value : {&color.red, &color.green, &color.blue}) {
      *value = static_cast<std::uint8_t>(255 - (255 - *value) * 6 / 10);
    }
  }
  return color;
}

std::string model_label(std::span<const EvaluationMesh> meshes, const std::string& name) {
  const EvaluationMesh* const mesh = find_mesh(meshes, name);
  if (!mesh) return escape_html(name);
  return fmt::format(
      "<span class=\"label\"><i class=\"swatch\" "
      "style=\"background:{}\"></i><span>{}</span></span>",
      css(model_color(meshes, *mesh)), escape_html(name));
}

std::string picture_labels(std::span<const PictureLabel> labels, std::span<const DrawnBox> boxes) {
  // Sizes of a letter and of a line in a picture of usual size, as fractions of the picture.
  constexpr float kLetter = 0.0125F, kLine = 0.045F;
  struct Spot {
    float x, y, width;
  };
  std::vector<Spot> occupied;
  std::string out;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (labels[i].text.empty() || boxes[i].left > boxes[i].right) continue;
    Spot spot{std::clamp(boxes[i].label_x, 0.08F, 0.92F),
              std::clamp(boxes[i].label_y, 0.03F, 0.97F),
              kLetter * static_cast<float>(labels[i].text.size() + 2)};
    const auto overlaps = [&](const Spot& other) {
      return std::abs(spot.x - other.x) < (spot.width + other.width) / 2 &&
             std::abs(spot.y - other.y) < kLine;
    };
    while (spot.y + kLine < 0.97F && std::any_of(occupied.begin(), occupied.end(), overlaps))
      spot.y += kLine;
    occupied.push_back(spot);
    out += fmt::format(
        "<span class=\"tag\" style=\"left:{:.1f}%;top:{:.1f}%;border-color:{}\">{}</span>",
        100 * spot.x, 100 * spot.y, css(labels[i].color), escape_html(labels[i].text));
  }
  return out;
}

std::string layered_view(const std::string& id, std::span<const ViewLayer> layers,
                         std::size_t shown) {
  std::string out = "<div class=\"layers\" role=\"radiogroup\" aria-label=\"What is drawn\">";
  for (std::size_t k = 0; k < layers.size(); ++k) {
    out += fmt::format(
        "<input type=\"radio\" name=\"{0}\" id=\"{0}_{1}\"{2}><label for=\"{0}_{1}\">{3}</label>",
        id, k, k == shown ? " checked" : "", escape_html(layers[k].name));
  }
  for (const ViewLayer& layer : layers) out += "<div class=\"view\">" + layer.content + "</div>";
  return out + "</div>";
}

}  // namespace trivet::apps
