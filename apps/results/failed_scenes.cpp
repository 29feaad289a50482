#include "apps/results/failed_scenes.hpp"

#include <fmt/format.h>

namespace trivet::apps {

Result<void> failed_scenes(const std::vector<Error>& failures, std::size_t num_scenes) {
  if (failures.empty()) return {};
  if (num_scenes == 1) return failures.front();
  Error all{failures.front().code,
            fmt::format("{} of {} scenes failed{}:", failures.size(), num_scenes,
                        failures.size() < num_scenes ? ", the others are reported" : "")};
  for (const Error& failure : failures) all.message += "\n" + failure.message;
  return all;
}

}  // namespace trivet::apps
