/// JSON documents as text: the one way in which they are written and read.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "storage/files/numbers.hpp"

namespace trivet {

/// A document as text that any parser takes, whatever bytes its strings hold: those that are no
/// UTF-8 become U+FFFD. It does nothing to a terminal: what printable() tells otherwise is escaped.
///
/// indent  spaces a level; < 0: all in one line
std::string json_text(const nlohmann::json& document, int indent = -1);
std::string json_text(const nlohmann::ordered_json& document, int indent = -1);

/// The document that a text is; a discarded one where it is none. Numbers are read alike whatever
/// the locale, which nlohmann's parser would ask.
template <class Json = nlohmann::json>
Json parse_json(std::string_view text) {
  const PlainLocale plain;
  return Json::parse(text.begin(), text.end(), nullptr, false);
}

}  // namespace trivet
