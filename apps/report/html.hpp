/// The parts of the report that are about HTML only.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "storage/common/counted.hpp"

namespace trivet::apps {

/// Everything before and after the page's content. `title` is plain text.
std::string html_page(std::string_view title, std::string_view content);

/// Text, as printable_lines() tells it, as it may stand between tags and in quoted attributes.
std::string escape_html(std::string_view bytes);

/// "97.2 %".
std::string percent(double share);

/// A number that stands out, with its title and a note. HTML goes in as it is.
std::string card(std::string_view title, std::string_view value, std::string_view note);

/// Bytes of a PNG as an address that holds them.
std::string png_address(std::span<const std::byte> png);

}  // namespace trivet::apps
