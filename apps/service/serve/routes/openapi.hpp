/// The OpenAPI 3.1 description of the service: apps/service/serve/api/openapi.json with the
/// parameters of a recognition.
#pragma once

#include <string_view>

namespace trivet::apps::service {

std::string_view openapi_document();

}  // namespace trivet::apps::service
