#include "engine/options/presets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "storage/common/valid_text.hpp"
#include "storage/files/nearest_name.hpp"

namespace trivet {

Result<RecognizeOptions> parse_recognize_options(
    std::span<const std::pair<std::string_view, std::string_view>> texts,
    std::string_view names_where, std::vector<std::string_view> more) {
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
      std::ranges::move(option_names<RecognizeOptions>(), std::back_inserter(more));
      more.push_back(kPreset.name);
      const std::string_view nearest = nearest_name(name, more);
      return Error{
          ErrorCode::usage,
          fmt::format("expected a parameter that {} names, found '{}'{}", names_where,
                      printable(name),
                      nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest))};
    }
    TRIVET_TRY(set_option(*option, text, options));
  }
  TRIVET_TRY(validate(options));
  return options;
}

}  // namespace trivet
