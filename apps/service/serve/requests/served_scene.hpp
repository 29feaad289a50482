/// How a client's scan is read.
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
  Camera image{};  ///< known values of its images: depth, distortion, width and height
  std::optional<Eigen::Vector3d> viewpoint{};  ///< sensor position, in the scan's frame and unit
  std::optional<LengthUnit> unit{};            ///< absent: the library's

  SceneInput input(LengthUnit library_unit) const;
  /// Adds the known values of the images to the camera, once all are set.
  /// Errors: usage (no camera, meaningless numbers).
  Result<void> complete_camera();
};

/// The peak memory of a cloud of so many points or pixels while it is read and recognized.
std::size_t scene_bytes(std::uint64_t num_points);

/// The peak memory of a scan that read_scan may read, from its header. The scan's bytes are not
/// included.
std::size_t scan_bytes(std::span<const std::byte> bytes, const std::string& name);

/// Reads a scan of at most 16 million points or pixels and 512 MiB uncompressed. `name` identifies
/// it in messages, and its extension gives the format. Errors: those of read_cloud.
Result<Cloud> read_scan(std::span<const std::byte> bytes, const std::string& name,
                        const ServedScene& scene, LengthUnit library_unit, bool intensity = false);

}  // namespace trivet::apps::service

template <>
std::span<const trivet::Option<trivet::apps::service::ServedScene>>
trivet::options_of<trivet::apps::service::ServedScene>();
