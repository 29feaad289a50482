#include "apps/service/serve/recognize_query.hpp"

#include <fmt/format.h>

#include <set>

#include "apps/options/presets.hpp"

namespace trivet::apps::service {
namespace {

constexpr OptionInfo kPreset = preset_option("What is searched", "Between speed and recall");

}  // namespace

const OptionInfo& preset_parameter() { return kPreset; }

Result<RecognizeQuery> parse_recognize_query(const Parameters& parameters) {
  RecognizeQuery query;
  std::set<std::string_view> names;
  for (const auto& [name, value] : parameters) {
    if (!names.insert(name).second)
      return Error{ErrorCode::usage, fmt::format("{}: expected once, found twice", name)};
    if (name != kPreset.name) continue;
    const Result<void> known = check_option(kPreset, value);
    if (!known) return named(kPreset, known.error());
    query.options = recognize_presets().find(value)->second;
  }
  for (const auto& [name, value] : parameters) {
    Result<void> set;
    if (const auto* const option = find_option<RecognizeOptions>(name)) {
      set = set_option(*option, value, query.options);
    } else if (const auto* const of_scene = find_option<ServedScene>(name)) {
      set = set_option(*of_scene, value, query.scene);
    } else if (name != kPreset.name) {
      return Error{
          ErrorCode::usage,
          fmt::format("expected a parameter that /v1/openapi.json names, found '{}'", name)};
    }
    if (!set) return set.error();
  }
  if (const Result<void> valid = validate(query.options); !valid) return valid.error();
  return query;
}

}  // namespace trivet::apps::service
