#include "engine/presets.hpp"

#include <fmt/format.h>

#include <set>

namespace trivet {

Result<RecognizeOptions> parse_recognize_options(
    std::span<const std::pair<std::string_view, std::string_view>> texts,
    std::string_view names_where) {
  constexpr OptionInfo kPreset = preset_option("", "");
  RecognizeOptions options;
  std::set<std::string_view> names;
  for (const auto& [name, text] : texts) {
    if (!names.insert(name).second)
      return Error{ErrorCode::usage, fmt::format("{}: expected once, found twice", name)};
    if (name != kPreset.name) continue;
    const Result<void> known = check_option(kPreset, std::string(text));
    if (!known) return named(kPreset, known.error());
    options = recognize_presets().find(text)->second;
  }
  for (const auto& [name, text] : texts) {
    if (name == kPreset.name) continue;
    const auto* const option = find_option<RecognizeOptions>(name);
    if (!option) {
      return Error{ErrorCode::usage, fmt::format("expected a parameter that {} names, found '{}'",
                                                 names_where, name)};
    }
    if (const Result<void> set = set_option(*option, text, options); !set) return set.error();
  }
  if (const Result<void> valid = validate(options); !valid) return valid.error();
  return options;
}

}  // namespace trivet
