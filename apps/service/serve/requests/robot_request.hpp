/// Requests for the poses of detections in the convention of a robot controller.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps::service {

/// The response to a request in JSON, as the description of the service gives both: the poses of
/// each detection, the same as a table, and which lengths of the setup suggest another unit.
/// Grasps of models that the library does not have are left out.
/// Errors: bad_data (names the JSON path of the fault).
Result<nlohmann::ordered_json> robot_poses_json(const std::string& body, const Library& library);

}  // namespace trivet::apps::service
