#include "apps/service/serve/openapi.hpp"

#include <span>
#include <utility>

namespace trivet::apps::service {

/// Defined by what cmake/embed.cmake writes.
std::span<const std::pair<std::string_view, std::string_view>> embedded_api();

std::string_view openapi_document() { return embedded_api().front().second; }

}  // namespace trivet::apps::service
