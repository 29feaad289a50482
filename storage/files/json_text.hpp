/// JSON documents as text: the one place where they are written and parsed.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "storage/files/numbers.hpp"

namespace trivet {

/// A document as text that any parser accepts, whatever bytes its strings hold: invalid UTF-8
/// becomes U+FFFD. The text has no effect on a terminal: characters that printable() replaces are
/// escaped.
///
/// indent  spaces per level; < 0: all in one line
std::string json_text(const nlohmann::json& document, int indent = -1);
std::string json_text(const nlohmann::ordered_json& document, int indent = -1);

/// Parses text; gives a discarded document on a syntax error. Numbers are parsed independently of
/// the locale, which nlohmann's parser would use.
template <class Json = nlohmann::json>
Json parse_json(std::string_view text) {
  const PlainLocale plain;
  return Json::parse(text.begin(), text.end(), nullptr, false);
}

}  // namespace trivet
