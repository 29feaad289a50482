#include "engine/scene/read_scene.hpp"

#include "storage/formats/read_cloud.hpp"

namespace trivet {

Result<Cloud> read_scene(const SceneInput& input) {
  ReadOptions options;
  options.camera = input.camera;
  options.unit = input.unit;
  options.format = input.format;
  return input.bytes ? read_cloud(*input.bytes, "standard input", options)
                     : read_cloud(input.file, options);
}

}  // namespace trivet
