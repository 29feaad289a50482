#include "apps/results/write_json.hpp"

#include "apps/results/standard_output.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps {

Result<void> write_json(const std::string& target, const nlohmann::ordered_json& document) {
  const std::string text = json_text(document, 1) + "\n";
  if (target != "-") return publish_file(target, std::as_bytes(std::span(text)));
  return write_output(text);
}

}  // namespace trivet::apps
