/// Multipart bodies, as sent by HTML forms and `curl -F`.
///
/// Source: RFC 7578 (multipart/form-data), RFC 2046, 5.1.1 (boundaries).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

struct FormPart {
  std::string name, file_name;  ///< file_name: empty if absent
  std::string_view content;     ///< view into the body
};

bool is_form(std::string_view content_type);

/// Splits a body into its parts. Errors: bad_data (what was expected, and the byte).
Result<std::vector<FormPart>> split_form(std::string_view content_type, std::string_view body);

}  // namespace trivet::apps::service
