/// Content codings: compression of bodies for the transfer.
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

/// The coding that a Content-Encoding header names; none: several codings, or an unknown one.
std::optional<ContentCoding> content_coding(std::string_view content_encoding);

/// The coding that an Accept-Encoding header prefers. Among equals, the first in the order above
/// but identity wins. Identity remains where no other coding is accepted.
ContentCoding accepted_coding(std::string_view accept_encoding);

/// Decompresses a body up to the byte after `max_bytes`: a longer result means that the body is too
/// long.
///
/// coding  not identity
/// Errors: bad_data (the byte, and what is wrong there), internal (out of memory).
Result<std::string> unpack(ContentCoding coding, std::string_view packed, std::size_t max_bytes);

/// Compresses a body, for speed rather than size; none: out of memory.
///
/// coding  not identity
std::optional<std::string> pack(ContentCoding coding, std::string_view bytes);

}  // namespace trivet::apps::service
