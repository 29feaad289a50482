#include "storage/files/json_text.hpp"

#include "storage/common/valid_text.hpp"

namespace trivet {
namespace {

template <class Json>
std::string dumped(const Json& document, int indent) {
  return printable_lines(document.dump(indent, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

std::string json_text(const nlohmann::json& document, int indent) {
  return dumped(document, indent);
}

std::string json_text(const nlohmann::ordered_json& document, int indent) {
  return dumped(document, indent);
}

}  // namespace trivet
