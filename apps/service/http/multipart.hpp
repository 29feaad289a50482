/// Bodies of several parts, as HTML forms and `curl -F` send them.
///
/// Source: RFC 7578 (multipart/form-data), RFC 2046, 5.1.1 (boundaries).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

struct FormPart {
  std::string name, file_name;  ///< file_name: empty where there is none
  std::string_view content;     ///< within the body
};

bool is_form(std::string_view content_type);

/// Errors: bad_data (what was expected, and the byte).
Result<std::vector<FormPart>> split_form(std::string_view content_type, std::string_view body);

}  // namespace trivet::apps::service
