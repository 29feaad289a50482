/// Where the sensor of a scan stood.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"

namespace trivet::engine {

/// Tell the position of the sensor in the cloud's frame, in its unit: as given, else as the cloud
/// says, else the origin of its file.
///
/// given  in the frame of the cloud's file
/// name   of the cloud, for messages
/// Errors: bad_data (of a cloud with an offset: so far away that floats cannot hold the distances of
/// its points well enough beside their spacing).
Result<Eigen::Vector3f> find_viewpoint(const Cloud& cloud,
                                       const std::optional<Eigen::Vector3d>& given,
                                       const std::string& name);

}  // namespace trivet::engine
