#include "apps/results/json_output.hpp"

#include <fmt/format.h>

#include "storage/file.hpp"

namespace trivet::apps {

Result<void> write_json(const std::string& target, const nlohmann::ordered_json& document) {
  const std::string text = document.dump(1) + "\n";
  if (target != "-") return publish_file(target, std::as_bytes(std::span(text)));
  fmt::print("{}", text);
  return {};
}

}  // namespace trivet::apps
