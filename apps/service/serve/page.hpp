/// The page of the service, a part of the program.
#pragma once

#include <string_view>

namespace trivet::apps::service {

struct PageFile {
  std::string_view path;  ///< within the page, as assets/page.js
  std::string_view content_type, bytes;
};

/// Null where there is none; everywhere, where the program was built without the page.
const PageFile* find_page_file(std::string_view path);

}  // namespace trivet::apps::service
