#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "storage/files/file.hpp"
#include "storage/files/json_file.hpp"
#include "storage/files/numbers.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/camera_json.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

constexpr std::int64_t kMaxImageId = 999'999'999;
constexpr std::uint64_t kMaxCameraBytes = 256ULL << 20;  // scene_camera.json of a long scene

bool is_number(const std::string& key) { return parse_integer(key).has_value(); }

Camera camera_of(const JsonNode& root, std::optional<int> image_id) {
  const auto members = root.members();
  const bool lists_images =
      std::ranges::any_of(members, [](const auto& member) { return is_number(member.first); });
  if (!lists_images) return parse_camera(root);
  if (image_id) return parse_camera(root.at(std::to_string(*image_id)));
  root.refuse(
      "expected one camera, or a scene_camera.json together with the id of an image: the number "
      "that is the image's name, as in 000003.png, or --image-id");
}

/// Contents of cam_K.txt and the like: all words of a short text, if these are numbers.
std::vector<double> numbers_of(std::string_view text) {
  constexpr std::size_t kMost = 16;
  std::vector<double> numbers;
  formats::TextCursor cursor(text, ",;");
  for (std::string_view word = cursor.next_word(); !word.empty(); word = cursor.next_word()) {
    const auto number = parse_number(word);
    if (!number || numbers.size() == kMost) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

/// Convert nine matrix numbers by rows, or fx fy cx cy, to JSON and parse it.
Result<Camera> camera_of_numbers(const std::vector<double>& numbers, const std::string& name) {
  const bool finite = std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); });
  if ((numbers.size() != 9 && numbers.size() != 4) || !finite) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected the 9 numbers of a camera's matrix, or 4, fx fy cx cy, "
                             "found {}{}",
                             name, numbers.size(), finite ? "" : ", not all finite")};
  }
  const auto text = numbers.size() == 9
                        ? fmt::format(R"({{"cam_K": [{}]}})", fmt::join(numbers, ", "))
                        : fmt::format(R"({{"fx": {}, "fy": {}, "cx": {}, "cy": {}}})", numbers[0],
                                      numbers[1], numbers[2], numbers[3]);
  Camera camera;
  TRIVET_TRY(with_json(std::as_bytes(std::span(text)), name,
                       [&](const JsonNode& root) { camera = parse_camera(root); }));
  return camera;
}

/// ROS calibration files are YAML, with names before colons.
bool is_yaml(std::string_view text) {
  const auto says = [&](std::string_view name) {
    return text.find(name) != std::string_view::npos;
  };
  return says("camera_matrix:") || says("image_width:") || says("distortion_model:") || says("fx:");
}

}  // namespace

Result<Camera> read_camera(std::span<const std::byte> bytes, const std::string& name,
                           std::optional<int> image_id) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string_view begin = text.substr(0, 4096);
  if (const std::vector<double> numbers = numbers_of(text); !numbers.empty())
    return camera_of_numbers(numbers, name);
  if (begin.find('{') == std::string_view::npos && is_yaml(begin)) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected a camera as JSON, found YAML; write {{\"fx\": ..., "
                             "\"fy\": ..., \"cx\": ..., \"cy\": ..., \"depth_scale\": ..., "
                             "\"distortion\": [k1, k2, p1, p2, k3]}}",
                             name)};
  }
  Camera camera;
  TRIVET_TRY(
      with_json(bytes, name, [&](const JsonNode& root) { camera = camera_of(root, image_id); }));
  return camera;
}

Result<Camera> read_camera(const std::filesystem::path& file, std::optional<int> image_id) {
  TRIVET_TRY_ASSIGN(const auto bytes, read_file(file, kMaxCameraBytes));
  return read_camera(bytes, file.string(), image_id);
}

std::optional<int> image_id_of(const std::filesystem::path& image) {
  const auto id = parse_integer(image.stem().string());
  if (!id || *id < 0 || *id > kMaxImageId) return std::nullopt;
  return static_cast<int>(*id);
}

}  // namespace trivet
