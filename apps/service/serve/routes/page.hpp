/// The page of the service, embedded in the program.
#pragma once

#include <string_view>

#include "apps/service/http/http_server.hpp"

namespace trivet::apps::service {

struct PageFile {
  std::string_view path;  ///< within the page, such as assets/page.js
  std::string_view content_type, bytes;
};

/// A file of the page; null: no such file, or the program was built without the page.
const PageFile* find_page_file(std::string_view path);

/// The response of a program that was built without the page: 404 with instructions to build it, as
/// HTML for a browser, else as JSON.
HttpResponse no_page_response(const HttpRequest& request);

}  // namespace trivet::apps::service
