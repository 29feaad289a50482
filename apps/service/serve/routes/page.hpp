/// The page of the service, a part of the program.
#pragma once

#include <string_view>

#include "apps/service/http/http_server.hpp"

namespace trivet::apps::service {

struct PageFile {
  std::string_view path;  ///< within the page, as assets/page.js
  std::string_view content_type, bytes;
};

/// Null where there is none; everywhere, where the program was built without the page.
const PageFile* find_page_file(std::string_view path);

/// What a program that was built without the page answers in its place: 404 with how to get it, as
/// a page of its own to a browser, else as JSON.
HttpResponse no_page_response(const HttpRequest& request);

}  // namespace trivet::apps::service
