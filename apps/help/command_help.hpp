/// What the commands say of themselves, as data: pages, manuals and completions are made of it.
#pragma once

#include <string>
#include <vector>

namespace trivet::apps {

struct OptionHelp {
  std::vector<std::string> names;    ///< "-o", "--output"; of an argument its place, as "SCENE"
  std::string type;                  ///< of its value, as "FILE", "TEXT:{m,mm}"; empty: a flag
  std::string usual;                 ///< the default; empty: none is told
  std::string meaning;               ///< may have several lines
  std::vector<std::string> choices;  ///< values that there are; none: any
  bool is_argument = false;          ///< known by its place, not by a name
  bool is_required = false;
  bool is_repeated = false;  ///< several values, or several names by commas
  bool is_list = false;      ///< of those, names by commas
};

struct OptionGroupHelp {
  std::string title;
  std::vector<OptionHelp> options;
};

struct CommandHelp {
  std::string name;                     ///< with those above it, as "trivet library info"
  std::string meaning;                  ///< the first line says it in short
  std::string footer;                   ///< stands behind the options
  std::vector<OptionGroupHelp> groups;  ///< in the order in which one needs them
  std::vector<CommandHelp> commands;    ///< below it
};

/// The title of options that print what the program says of itself, and no command needs.
inline constexpr const char* kAbout = "About";

/// Those of the program that every command has, too.
std::vector<OptionHelp> common_options(const CommandHelp& program);

/// What a text says in short: its first line.
std::string first_line(const std::string& text);

}  // namespace trivet::apps
