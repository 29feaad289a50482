/// Descriptions of the commands as data, from which help pages, manuals and completions are made.
#pragma once

#include <string>
#include <vector>

namespace trivet::apps {

struct OptionHelp {
  std::vector<std::string> names;  ///< "-o", "--output"; "SCENE" for a positional argument
  std::string type;     ///< type of the value, such as "FILE", "TEXT:{m,mm}"; empty: a flag
  std::string usual;    ///< the default; empty: not shown
  std::string meaning;  ///< may have several lines
  std::vector<std::string> choices;  ///< allowed values; none: any
  bool is_argument = false;          ///< positional, without a name
  bool is_required = false;
  bool is_repeated = false;  ///< several values, or several names separated by commas
  bool is_list = false;      ///< a repeated option with names separated by commas
};

struct OptionGroupHelp {
  std::string title;
  std::vector<OptionHelp> options;
};

struct CommandHelp {
  std::string name;     ///< with the commands above it, such as "trivet library info"
  std::string meaning;  ///< the first line is a summary
  std::string footer;   ///< printed after the options
  std::vector<OptionGroupHelp> groups;  ///< in the order of use
  std::vector<CommandHelp> commands;    ///< subcommands
};

/// The title of options that print information about the program, which no command needs.
inline constexpr const char* kAbout = "About";

/// The options of the program that every command also has.
std::vector<OptionHelp> common_options(const CommandHelp& program);

/// The summary of a text: its first line.
std::string first_line(const std::string& text);

}  // namespace trivet::apps
