/// What a scene comes as.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/length_unit.hpp"

namespace trivet {

/// What the sensor was.
struct SceneInput {
  std::filesystem::path file{};
  std::optional<Camera> camera{};              ///< of a depth image
  std::optional<Eigen::Vector3d> viewpoint{};  ///< position of the sensor in the file's frame
  /// No sensor: a whole surface, normals by its faces. Found by itself for a mesh whose faces no one
  /// place sees; a scene whose file holds a pixel grid or a viewpoint is a scan all the same.
  bool closed_surface = false;
  double scale = 1;  ///< multiplies the file's coordinates, giving the library's unit
  /// What came over standard input; `file` is then a name only.
  std::shared_ptr<const std::vector<std::byte>> bytes{};
  std::string format{};              ///< one of cloud_extensions(); empty: by the name
  std::optional<LengthUnit> unit{};  ///< of the coordinates; files that say another are converted
};

/// Read the cloud or depth image of a scene. Errors: those of read_cloud.
Result<Cloud> read_scene(const SceneInput& input);

}  // namespace trivet
