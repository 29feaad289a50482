#include "apps/options/add_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

namespace trivet::apps {
namespace {

const char* type_text(OptionKind kind) {
  switch (kind) {
    case OptionKind::flag:
      return "";
    case OptionKind::number:
      return "NUMBER";
    case OptionKind::count:
      return "N";
    case OptionKind::choice:
      return "NAME";
    case OptionKind::numbers:
      return "X,Y,...";
    case OptionKind::names:
      return "A,B,...";
  }
  return "";
}

/// "fused,ppf,trisi": the name of a check, from which completions read the choices.
std::string choice_names(const OptionInfo& info) {
  std::vector<std::string_view> names;
  for (const Choice& choice : info.choices) names.push_back(choice.name);
  return fmt::format("{}", fmt::join(names, ","));
}

/// "Meaning, 0 to 1 [diameter]", and a line for each choice with a description.
std::string help_text(const OptionInfo& info, const OptionValue& usual) {
  std::string text(info.help);
  if (info.choices.empty()) {
    const std::string range = range_text(info);
    if (!info.unit.empty()) text += fmt::format(" [{}]", info.unit);
    if (!range.empty()) text += fmt::format("; {}", range);
    if (is_unset(usual) && !info.unset_help.empty())
      text += fmt::format(" (default: {})", info.unset_help);
    return text;
  }
  text += ':';
  for (const Choice& choice : info.choices) {
    if (!choice.sentence.empty()) {
      text += fmt::format("\n{}: {}", choice.name, choice.sentence);
    } else {
      text += fmt::format("{} {}", &choice == info.choices.data() ? "" : ",", choice.name);
    }
  }
  return text;
}

}  // namespace

bool GivenOption::is_given() const { return option && option->count() > 0; }

CLI::Option* add_option(CLI::App& command, const OptionInfo& info, const OptionValue& usual,
                        GivenOption& given) {
  const std::string flag = fmt::format("--{}", info.name);
  const std::string help = help_text(info, usual);
  if (info.kind == OptionKind::flag) {
    given.option = command.add_flag(flag, given.text, help);
  } else {
    given.option = command.add_option(flag, given.text, help)->type_name(type_text(info.kind));
    if (!is_unset(usual)) given.option->default_str(value_text(usual));
  }
  given.option->group(std::string(info.group))
      ->check(
          [info](const std::string& text) {
            const Result<OptionValue> value = parse_option(info, text);
            if (!value) return value.error().message;
            const Result<void> valid = check_option(info, *value);
            return valid ? std::string() : valid.error().message;
          },
          "", choice_names(info));
  return given.option;
}

CLI::Option* limit_to(CLI::Option* option, const std::vector<std::string>& names) {
  return option->check(CLI::IsMember(names).description(""),
                       fmt::format("{}", fmt::join(names, ",")));
}

}  // namespace trivet::apps
