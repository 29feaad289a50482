/// How a client requests the reading of a listed scene.
#pragma once

#include <string>

#include "storage/datasets/manifest.hpp"

namespace trivet::apps::service {

/// The parameters of a recognition: format, unit, and the known values of camera and viewpoint.
std::string reading_query(const ManifestScene& scene, LengthUnit unit);

}  // namespace trivet::apps::service
