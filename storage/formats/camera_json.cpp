#include "storage/formats/camera_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "storage/files/text.hpp"

namespace trivet {
namespace {

/// The last part of a name in lower case with underscores: "CameraModelType.PINHOLE",
/// "RS2_DISTORTION_BROWN_CONRADY" and "Brown Conrady" are pinhole and brown_conrady.
std::string plain_name(std::string_view name) {
  if (const std::size_t dot = name.rfind('.'); dot != std::string_view::npos)
    name.remove_prefix(dot + 1);
  std::string plain = formats::lower_case(name);
  std::ranges::replace_if(
      plain, [](char c) { return c == ' ' || c == '-'; }, '_');
  constexpr std::string_view kRealSense = "rs2_distortion_";
  if (plain.starts_with(kRealSense)) plain.erase(0, kRealSense.size());
  return plain;
}

/// Numbers as a list, as rows, or in OpenCV's form {"rows", "cols", "data"}.
std::vector<double> numbers_of(const JsonNode& node) {
  return node.value().is_object() ? node.at("data").flat_numbers() : node.flat_numbers();
}

enum class Order { rows, columns };

constexpr double kRounding = 1e-6;  // tolerance for zeros and ones [pixel]

/// Parse the matrix fx 0 cx, 0 fy cy, 0 0 1.
void read_matrix(const JsonNode& node, Order order, Camera& camera) {
  const std::vector<double> m = numbers_of(node);
  if (m.size() != 9) node.refuse(fmt::format("expected 9 numbers instead of {}", m.size()));
  const auto at = [&](std::size_t row, std::size_t column) {
    return order == Order::rows ? m[3 * row + column] : m[3 * column + row];
  };
  const auto is = [](double value, double expected) {
    return std::abs(value - expected) <= kRounding;
  };
  if (!is(at(2, 0), 0) || !is(at(2, 1), 0) || !is(at(2, 2), 1)) {
    node.refuse(fmt::format("expected a matrix by {} whose last row is 0 0 1; it may be transposed",
                            order == Order::rows ? "rows" : "columns"),
                fmt::format("{} {} {}", at(2, 0), at(2, 1), at(2, 2)));
  }
  if (!is(at(0, 1), 0) || !is(at(1, 0), 0)) {
    node.refuse(
        "expected a camera without skew, fx 0 cx in the first row and 0 fy cy in the second",
        fmt::format("{} {} {} and {} {} {}", at(0, 0), at(0, 1), at(0, 2), at(1, 0), at(1, 1),
                    at(1, 2)));
  }
  camera.fx = at(0, 0), camera.fy = at(1, 1), camera.cx = at(0, 2), camera.cy = at(1, 2);
}

/// Parse {"projection_model_type", "projection_params": [fx, fy, cx, cy, and zeros]}, BOP's form
/// since 2024.
void read_camera_model(const JsonNode& model, Camera& camera) {
  const JsonNode type = model.at("projection_model_type"), list = model.at("projection_params");
  const std::string name = plain_name(type.string());
  if (!name.starts_with("pinhole") && name != "linear")
    type.refuse("expected a pinhole camera",
                fmt::format("\"{}\"; rectify its images", type.string()));
  const std::vector<double> parameters = list.flat_numbers();
  if (parameters.size() < 4)
    list.refuse(fmt::format("expected fx, fy, cx, cy instead of {} numbers", parameters.size()));
  if (std::any_of(parameters.begin() + 4, parameters.end(), [](double d) { return d != 0; }))
    list.refuse("expected no distortion, found some; rectify the images");
  camera.fx = parameters[0], camera.fy = parameters[1];
  camera.cx = parameters[2], camera.cy = parameters[3];
}

/// The first existing one of these members.
const char* find_member(const JsonNode& node, std::initializer_list<const char*> names) {
  const auto* const found = std::ranges::find_if(names, [&](auto name) { return node.has(name); });
  return found == names.end() ? nullptr : *found;
}

void read_projection(const JsonNode& node, Camera& camera) {
  if (node.has("cam_model")) {
    read_camera_model(node.at("cam_model"), camera);
  } else if (const char* const rows = find_member(node, {"cam_K", "K", "k", "camera_matrix"})) {
    read_matrix(node.at(rows), Order::rows, camera);
  } else if (node.has("intrinsic_matrix")) {
    read_matrix(node.at("intrinsic_matrix"), Order::columns, camera);
  } else if (!find_member(node, {"fx", "fy", "cx", "cy", "ppx", "ppy"})) {
    (void)node.object();
    node.refuse(
        "expected \"fx\", \"fy\", \"cx\", \"cy\" and \"depth_scale\", or a camera of BOP "
        "(\"cam_K\"), "
        "ROS (\"k\"), Open3D (\"intrinsic_matrix\") or RealSense (\"ppx\")");
  } else {
    camera.fx = node.at("fx").number();
    camera.fy = node.at("fy").number();
    camera.cx = node.at(node.has("ppx") ? "ppx" : "cx").number();
    camera.cy = node.at(node.has("ppy") ? "ppy" : "cy").number();
  }
}

constexpr std::array<const char*, 8> kCoefficients{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};

/// Member names of coefficient lists.
constexpr std::array<const char*, 5> kDistortions{"distortion", "coeffs", "d", "D",
                                                  "distortion_coefficients"};

using Coefficients = std::array<double, kCoefficients.size()>;

Coefficients coefficients_of(const LensDistortion& d) {
  return {d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6};
}

/// 4 to 8 numbers in OpenCV's order. The thin prism and tilt coefficients that OpenCV appends are
/// refused.
Coefficients parse_list(const JsonNode& node) {
  const std::vector<double> numbers = numbers_of(node);
  Coefficients c{};
  if (!numbers.empty() && numbers.size() < 4) {
    node.refuse(fmt::format("expected 4 to 8 numbers k1 k2 p1 p2 k3 k4 k5 k6 instead of {}",
                            numbers.size()));
  }
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (k < c.size())
      c[k] = numbers[k];
    else if (numbers[k] != 0)
      node.refuse("expected no distortion but k1 k2 p1 p2 k3 k4 k5 k6; rectify the images");
  }
  return c;
}

/// The name of the distortion model, if given. RealSense's SDK uses numbers.
std::string model_name(const JsonNode& node) {
  constexpr std::array kNumbered{"none",   "modified_brown_conrady", "inverse_brown_conrady",
                                 "ftheta", "brown_conrady",          "kannala_brandt4"};
  if (node.value().is_number())
    return kNumbered[static_cast<std::size_t>(node.integer(0, kNumbered.size() - 1))];
  return plain_name(node.string());
}

LensDistortion parse_distortion(const JsonNode& node) {
  constexpr std::string_view kAdvice =
      "rectify the images, as only the distortion of Brown and Conrady (plumb_bob, "
      "rational_polynomial, brown_conrady) is undone";
  const auto* const found =
      std::ranges::find_if(kDistortions, [&](const char* name) { return node.has(name); });
  const char* const list = found == kDistortions.end() ? nullptr : *found;
  Coefficients c{};
  if (list) c = parse_list(node.at(list));
  for (std::size_t k = 0; k < c.size(); ++k) {
    if (!node.has(kCoefficients[k])) continue;
    if (list) node.refuse(fmt::format("expected \"{}\" or \"{}\"", list, kCoefficients[k]), "both");
    c[k] = node.at(kCoefficients[k]).number();
  }
  const bool bends = std::ranges::any_of(c, [](double value) { return value != 0; });

  if (const char* const member = find_member(node, {"distortion_model", "model"})) {
    const JsonNode model = node.at(member);
    const std::string name = model_name(model);
    const auto is = [&](auto... names) { return ((name == names) || ...); };
    const bool same = is("plumb_bob", "rational_polynomial", "brown_conrady", "radtan") ||
                      // Brown-Conrady without tangential terms.
                      (is("modified_brown_conrady") && c[2] == 0 && c[3] == 0);
    const bool straight =
        !bends && is("", "none", "pinhole", "inverse_brown_conrady", "modified_brown_conrady");
    if (!same && !straight) model.refuse(fmt::format("expected no distortion; {}", kAdvice));
  }
  return {c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]};
}

/// Size of the images; 0 if not given.
std::uint32_t parse_size(const JsonNode& node, std::string_view name) {
  constexpr int kMost = 1'000'000;
  for (const std::string& member : {std::string(name), fmt::format("image_{}", name)}) {
    if (node.has(member)) return static_cast<std::uint32_t>(node.at(member).integer(0, kMost));
  }
  return 0;
}

/// ROS's matrix refers to the whole sensor, of which the images may be a part or a reduced copy.
void refuse_part_of_sensor(const JsonNode& node) {
  for (const char* binning : {"binning_x", "binning_y"}) {
    if (node.has(binning) && node.at(binning).number() > 1)
      node.at(binning).refuse(
          "expected a camera without binning; give fx, fy, cx, cy of the image");
  }
  if (!node.has("roi")) return;
  const JsonNode roi = node.at("roi");
  for (const char* member : {"x_offset", "y_offset"}) {
    if (roi.has(member) && roi.at(member).number() != 0)
      roi.at(member).refuse("expected the whole image; give fx, fy, cx, cy of the part");
  }
}

/// Unknown names are refused because they may be a distortion that would not be undone. BOP's
/// entries also hold other metadata of the image.
void refuse_unknown_names(const JsonNode& node) {
  if (node.has("cam_K") || node.has("cam_model")) {
    for (const auto& [name, value] : node.members()) {
      const bool is_read =
          std::ranges::find(kDistortions, name) != kDistortions.end() || name == "distortion_model";
      if (!is_read && (name.find("dist") != std::string::npos || name.starts_with("coef")))
        value.refuse("expected no distortion but \"distortion\"");
    }
    return;
  }
  node.only({"fx", "fy", "cx", "cy", "depth_scale", "depth", "width", "height", "distortion",
             "distortion_model", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6",
             // RealSense
             "ppx", "ppy", "model", "coeffs", "fps",
             // ROS; rectification and projection refer to derived images, not the camera's own
             "header", "K", "k", "D", "d", "R", "r", "P", "p", "binning_x", "binning_y", "roi",
             "camera_matrix", "distortion_coefficients", "rectification_matrix",
             "projection_matrix", "image_width", "image_height", "camera_name",
             // Open3D; its scenes stay in the frame of the camera
             "intrinsic_matrix", "class_name", "version_major", "version_minor"});
}

DepthKind parse_depth(const JsonNode& node) {
  const std::string name = node.string();
  if (name != "z" && name != "ray")
    node.refuse("expected \"z\", along the camera's axis, or \"ray\", along the ray of each pixel");
  return name == "ray" ? DepthKind::ray : DepthKind::z;
}

}  // namespace

Camera parse_camera(const JsonNode& node) {
  if (node.has("intrinsic")) return parse_camera(node.at("intrinsic"));  // Open3D, beside a pose
  Camera camera;
  read_projection(node, camera);
  refuse_unknown_names(node);
  if (node.has("depth_scale")) camera.depth_scale = node.at("depth_scale").number();
  if (node.has("depth")) camera.depth = parse_depth(node.at("depth"));
  camera.distortion = parse_distortion(node);
  refuse_part_of_sensor(node);
  const JsonNode sized = node.has("cam_model") ? node.at("cam_model") : node;
  camera.width = parse_size(sized, "width");
  camera.height = parse_size(sized, "height");
  if (!(camera.fx > 0 && camera.fy > 0 && camera.depth_scale > 0)) {
    node.refuse("expected fx, fy and depth_scale above zero",
                fmt::format("{}, {} and {}", camera.fx, camera.fy, camera.depth_scale));
  }
  return camera;
}

nlohmann::ordered_json camera_json(const Camera& camera) {
  nlohmann::ordered_json json{{"fx", camera.fx},
                              {"fy", camera.fy},
                              {"cx", camera.cx},
                              {"cy", camera.cy},
                              {"depth_scale", camera.depth_scale}};
  if (camera.depth == DepthKind::ray) json["depth"] = "ray";
  if (!camera.distortion.none()) json["distortion"] = coefficients_of(camera.distortion);
  if (camera.width > 0) json["width"] = camera.width;
  if (camera.height > 0) json["height"] = camera.height;
  return json;
}

}  // namespace trivet
