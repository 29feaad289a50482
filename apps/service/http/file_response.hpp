/// Files as bodies of responses, read while they are sent.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/service/common/file_reader.hpp"
#include "apps/service/http/http_messages.hpp"
#include "apps/service/http/http_server.hpp"

namespace trivet::apps::service {

/// A response with the rest of an opened file. It ends early if the file becomes shorter. 404
/// without a file.
HttpResponse file_response(std::optional<FileReader> file,
                           const std::string& content_type = kBytes);

/// A response with the whole file in its present state.
HttpResponse file_response(const std::filesystem::path& file,
                           const std::string& content_type = kBytes);

}  // namespace trivet::apps::service
