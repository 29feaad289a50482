/// Files as bodies, read while they are sent.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/service/common/file_reader.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/http/http_server.hpp"

namespace trivet::apps::service {

/// What is left of a file; ends early if it becomes shorter. 404 where there is none.
HttpResponse file_response(std::optional<FileReader> file,
                           const std::string& content_type = kBytes);

/// The whole file, as it is now.
HttpResponse file_response(const std::filesystem::path& file,
                           const std::string& content_type = kBytes);

}  // namespace trivet::apps::service
