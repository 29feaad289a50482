#include "apps/help/command_help.hpp"

namespace trivet::apps {

std::vector<OptionHelp> common_options(const CommandHelp& program) {
  std::vector<OptionHelp> options;
  for (const OptionGroupHelp& group : program.groups) {
    if (group.title != kAbout)
      options.insert(options.end(), group.options.begin(), group.options.end());
  }
  return options;
}

std::string first_line(const std::string& text) {
  std::string line = text.substr(0, text.find('\n'));
  if (line.ends_with(':')) line.pop_back();  // the line introduced a list
  return line;
}

}  // namespace trivet::apps
