/// How a client's scan is to be read.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/options/option.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps::service {

struct ServedScene {
  std::optional<Camera> camera{};
  Camera image{};  ///< what is known of its images: depth, distortion, width and height
  std::optional<Eigen::Vector3d> viewpoint{};  ///< of the sensor, in the scan's frame and unit
  std::optional<LengthUnit> unit{};            ///< absent: the library's

  SceneInput input(LengthUnit library_unit) const;
  /// Put what is known of the images to the camera, once all is set. Errors: usage (no camera,
  /// numbers that say nothing).
  Result<void> complete_camera();
};

/// The most memory that a cloud of so many points or pixels takes while it is read and recognized.
std::size_t scene_bytes(std::uint64_t num_points);

/// The same of a scan that read_scan may read, by its header. The scan's own bytes come beside it.
std::size_t scan_bytes(std::span<const std::byte> bytes, const std::string& name);

/// Read a scan of at most 16 million points or pixels and 512 MiB unpacked. `name` stands for it in messages and tells
/// the format by its extension. Errors: those of read_cloud.
Result<Cloud> read_scan(std::span<const std::byte> bytes, const std::string& name,
                        const ServedScene& scene, LengthUnit library_unit, bool intensity = false);

}  // namespace trivet::apps::service

template <>
std::span<const trivet::Option<trivet::apps::service::ServedScene>>
trivet::options_of<trivet::apps::service::ServedScene>();
