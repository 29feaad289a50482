/// What bodies are packed with on their way.
///
/// Source: RFC 9110, 8.4.1 (codings) and 12.5.3 (Accept-Encoding); RFC 1952 (gzip), RFC 1950 (zlib,
/// which HTTP calls deflate).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

enum class ContentCoding { identity, gzip, deflate };

std::string_view coding_name(ContentCoding coding);

/// What a Content-Encoding says; none: several codings, or one that is not known.
std::optional<ContentCoding> content_coding(std::string_view content_encoding);

/// The coding that an Accept-Encoding likes best, of like ones the first in the order above but
/// identity, which is what is left where it likes none.
ContentCoding accepted_coding(std::string_view accept_encoding);

/// Unpack a body up to the byte behind `max_bytes`: what is longer than these is too long.
/// coding  not identity
/// Errors: bad_data (the byte, and what is wrong there), internal (no memory).
Result<std::string> unpack(ContentCoding coding, std::string_view packed, std::size_t max_bytes);

/// Pack a body, soon rather than small; none: there is no memory for it.
/// coding  not identity
std::optional<std::string> pack(ContentCoding coding, std::string_view bytes);

}  // namespace trivet::apps::service
