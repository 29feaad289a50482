#include "apps/service/serve/requests/recognize_query.hpp"

#include <fmt/format.h>

#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/options/presets.hpp"

namespace trivet::apps::service {
namespace {

constexpr OptionInfo kPreset = preset_option("What is searched", "Between speed and recall");

}  // namespace

const OptionInfo& preset_parameter() { return kPreset; }

Result<RecognizeQuery> parse_recognize_query(const Parameters& parameters) {
  RecognizeQuery query;
  std::vector<std::pair<std::string_view, std::string_view>> of_recognition;
  std::set<std::string_view> of_scene;
  for (const auto& [name, value] : parameters) {
    const auto* const option = find_option<ServedScene>(name);
    if (!option) {
      of_recognition.emplace_back(name, value);
      continue;
    }
    if (!of_scene.insert(name).second)
      return Error{ErrorCode::usage, fmt::format("{}: expected once, found twice", name)};
    TRIVET_TRY(set_option(*option, value, query.scene));
  }
  TRIVET_TRY(query.scene.complete_camera());
  Result<RecognizeOptions> options =
      parse_recognize_options(of_recognition, "/v1/openapi.json", option_names<ServedScene>());
  if (!options) return options.error();
  query.options = *std::move(options);
  return query;
}

}  // namespace trivet::apps::service
