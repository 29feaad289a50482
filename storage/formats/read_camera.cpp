#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "storage/files/json_file.hpp"
#include "storage/files/numbers.hpp"
#include "storage/read_cloud.hpp"

namespace trivet {
namespace {

constexpr std::int64_t kMaxImageId = 999'999'999;

}  // namespace

Result<Camera> read_camera(const std::filesystem::path& file, std::optional<int> image_id) {
  Camera camera;
  auto done = with_json(file, [&](const JsonNode& root) {
    if (root.has("fx") || root.has("cam_K") || root.has("cam_model")) {
      camera = root.camera();
    } else if (image_id) {
      camera = root.at(std::to_string(*image_id)).camera();
    } else {
      root.refuse(
          "expected \"fx\", \"fy\", \"cx\", \"cy\" or \"cam_K\", or a scene_camera.json together "
          "with the id of an image: the number that is the image's name, as in 000003.png, or "
          "--image-id");
    }
  });
  if (!done) return done.error();
  return camera;
}

std::optional<int> image_id_of(const std::filesystem::path& image) {
  const auto id = parse_integer(image.stem().string());
  if (!id || *id < 0 || *id > kMaxImageId) return std::nullopt;
  return static_cast<int>(*id);
}

}  // namespace trivet
