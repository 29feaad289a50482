/// Viewpoint of a scan.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"

namespace trivet::engine {

/// The position of the sensor in the cloud's frame and unit: the given one, or else the cloud's, or
/// else the origin of its file.
///
/// given  viewpoint in the frame of the cloud's file
/// name   name of the cloud in messages
/// Errors: bad_data (for a cloud with an offset: so far away that floats cannot represent the
/// distances of its points accurately compared with their spacing).
Result<Eigen::Vector3f> find_viewpoint(const Cloud& cloud,
                                       const std::optional<Eigen::Vector3d>& given,
                                       const std::string& name);

}  // namespace trivet::engine
