/// Scene files and their sensors.
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

/// A scene's file and its sensor.
struct SceneInput {
  std::filesystem::path file{};
  std::optional<Camera> camera{};              ///< camera of a depth image
  std::optional<Eigen::Vector3d> viewpoint{};  ///< position of the sensor in the file's frame
  /// Whether the scene is a whole surface without a sensor, with normals from its faces. This is
  /// detected automatically for a mesh whose faces no single viewpoint sees. A scene whose file
  /// contains a pixel grid or a viewpoint is treated as a scan anyway.
  bool closed_surface = false;
  double scale = 1;  ///< factor from the file's coordinates to the library's unit
  /// Content of standard input; `file` is then only a name.
  std::shared_ptr<const std::vector<std::byte>> bytes{};
  std::string format{};  ///< one of cloud_extensions(); empty: by the file name
  /// Unit of the coordinates; files that declare another unit are converted.
  std::optional<LengthUnit> unit{};
};

/// Read the cloud or depth image of a scene. Errors: those of read_cloud.
Result<Cloud> read_scene(const SceneInput& input);

}  // namespace trivet
