/// The parts of the report that concern only HTML.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "storage/common/counted.hpp"

namespace trivet::apps {

/// Wraps the content in a complete page. `title` is plain text.
std::string html_page(std::string_view title, std::string_view content);

/// Text converted by printable_lines() and escaped for use between tags and in quoted attributes.
std::string escape_html(std::string_view bytes);

/// A fraction in the form "97.2 %".
std::string percent(double share);

/// A highlighted number with its title and a note. The arguments are HTML and are not escaped.
std::string card(std::string_view title, std::string_view value, std::string_view note);

/// A data URL with the bytes of a PNG.
std::string png_address(std::span<const std::byte> png);

}  // namespace trivet::apps
