/// JSON documents as text: the one way in which they are written.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace trivet {

/// A document as text that any parser takes, whatever bytes its strings hold: those that are no
/// UTF-8 become U+FFFD. It does nothing to a terminal: DEL and C1 are told as \u007f and so on, as
/// JSON has it for C0.
///
/// indent  spaces a level; < 0: all in one line
std::string json_text(const nlohmann::json& document, int indent = -1);
std::string json_text(const nlohmann::ordered_json& document, int indent = -1);

}  // namespace trivet
