#include <fmt/format.h>

#include <string>

#include "storage/files/json_file.hpp"
#include "storage/read_cloud.hpp"

namespace trivet {

Result<Camera> read_camera(const std::filesystem::path& file, std::optional<int> image_id) {
  Camera camera;
  auto done = with_json(file, [&](const JsonNode& root) {
    if (root.has("fx") || root.has("cam_K")) {
      camera = root.camera();
    } else if (image_id) {
      camera = root.at(std::to_string(*image_id)).camera();
    } else {
      root.refuse(
          "expected \"fx\", \"fy\", \"cx\", \"cy\" or \"cam_K\", or a scene_camera.json together "
          "with the id of an image");
    }
  });
  if (!done) return done.error();
  return camera;
}

}  // namespace trivet
