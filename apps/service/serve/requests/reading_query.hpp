/// How a listed scene is read, as a client asks for it.
#pragma once

#include <string>

#include "storage/datasets/manifest.hpp"

namespace trivet::apps::service {

/// The parameters of a recognition: format, unit, and what is known of camera and viewpoint.
std::string reading_query(const ManifestScene& scene, LengthUnit unit);

}  // namespace trivet::apps::service
