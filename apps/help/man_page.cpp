#include "apps/help/man_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>

#include "apps/help/exit_codes.hpp"

namespace trivet::apps {
namespace {

/// Removes the UTF-8 sequence at the front and returns its code point.
std::uint32_t pop_code_point(std::string_view& text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  const std::size_t length = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  std::uint32_t point = length == 1 ? lead : lead & (0x7FU >> length);
  for (std::size_t i = 1; i < length && i < text.size(); ++i)
    point = point << 6U | (static_cast<unsigned char>(text[i]) & 0x3FU);
  text.remove_prefix(std::min(length, text.size()));
  return point;
}

/// Text escaped for roff, in ASCII, except for special characters at the beginning of a line.
std::string escaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::uint32_t point = pop_code_point(text);
    if (point == '\\') {
      out += "\\e";
    } else if (point == '-') {
      out += "\\-";
    } else if (point == '`') {
      out += "\\(ga";
    } else if (point == '~') {
      out += "\\(ti";
    } else if (point == '^') {
      out += "\\(ha";
    } else if (point >= 0x80) {
      out += fmt::format("\\[u{:04X}]", point);
    } else {
      out += static_cast<char>(point);
    }
  }
  return out;
}

std::string bold(std::string_view text) { return "\\fB" + escaped(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + escaped(text) + "\\fR"; }

/// A line that is never a roff request, whatever it begins with.
std::string kept_line(std::string_view line) {
  return (line.starts_with('.') || line.starts_with('\'') ? "\\&" : "") + escaped(line) + '\n';
}

/// Text for roff to fill, in lines of at most 80 characters.
std::string filled_lines(const std::string& text) {
  constexpr std::size_t kMostCharacters = 78;
  std::istringstream words(text);
  std::string out, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && escaped(line).size() + 1 + escaped(word).size() > kMostCharacters) {
      out += kept_line(line);
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return line.empty() ? out : out + kept_line(line);
}

/// Paragraphs: indented lines stay as they are, others are filled.
std::string prose(const std::string& text) {
  std::istringstream lines(text);
  std::string out;
  bool is_kept = false, is_apart = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) {
      is_apart = true;
      continue;
    }
    const bool keep = line.starts_with("  ");
    if (!keep && is_kept) out += ".fi\n";
    if (is_apart && !out.empty()) out += ".PP\n";
    if (keep && !is_kept) out += ".nf\n";
    out += keep ? kept_line(line) : filled_lines(line);
    is_kept = keep;
    is_apart = false;
  }
  return is_kept ? out + ".fi\n" : out;
}

/// Each line separately.
std::string meaning_of(const OptionHelp& option) {
  std::istringstream lines(option.meaning);
  std::string out;
  for (std::string line; std::getline(lines, line);)
    out += (out.empty() ? "" : ".br\n") + filled_lines(line);
  if (!option.usual.empty()) out += ".br\n" + filled_lines("Default: " + option.usual);
  return out;
}

std::string option_text(const OptionHelp& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ", ") + (option.is_argument ? italic(name) : bold(name));
  if (!option.type.empty()) names += ' ' + italic(option.type);
  return ".TP\n" + names + '\n' + meaning_of(option);
}

std::string synopsis(const CommandHelp& command) {
  std::string out = ".B " + escaped(command.name) + '\n';
  if (!command.commands.empty()) out += italic("COMMAND") + '\n';
  out += "[" + italic("OPTION") + "]...\n";
  for (const OptionGroupHelp& group : command.groups) {
    for (const OptionHelp& option : group.options) {
      if (!option.is_argument) continue;
      std::string argument = italic(option.names.front());
      if (!option.is_required) argument = "[" + argument + "]";
      out += argument + (option.is_repeated ? "..." : "") + '\n';
    }
  }
  return out;
}

std::string options_text(const CommandHelp& command) {
  std::string arguments, out;
  for (const OptionGroupHelp& group : command.groups) {
    std::string options;
    for (const OptionHelp& option : group.options)
      (option.is_argument ? arguments : options) += option_text(option);
    if (!options.empty()) out += ".SS " + escaped(group.title) + '\n' + options;
  }
  return (arguments.empty() ? "" : ".SS Arguments\n" + arguments) + out;
}

std::string page_name(const CommandHelp& command) {
  std::string name = command.name;
  std::ranges::replace(name, ' ', '-');
  return name;
}

/// The meaning of a command after the first line, and its footer.
std::string description(const CommandHelp& command) {
  const std::size_t end = command.meaning.find('\n');
  const std::string rest = end == std::string::npos ? "" : command.meaning.substr(end + 1);
  return prose(rest + "\n\n" + command.footer);
}

std::string commands_text(const CommandHelp& program, const CommandHelp& command) {
  std::string out = ".SH COMMANDS\n";
  for (const CommandHelp& below : command.commands) {
    const bool has_page = &command == &program;
    out += ".TP\n" + (has_page ? bold(page_name(below)) + "(1)" : bold(below.name)) + '\n' +
           filled_lines(first_line(below.meaning));
  }
  return out;
}

std::string exit_status() {
  std::string out = ".SH EXIT STATUS\n.TP\n.B 0\nEverything was done.\n";
  for (const ExitCode& code : kExitCodes)
    out += fmt::format(".TP\n.B {}\n{}\n", code.number, escaped(code.meaning));
  return out;
}

std::string see_also(const CommandHelp& program, const CommandHelp& command) {
  std::string out;
  const auto add = [&](const CommandHelp& page) {
    if (&page != &command) out += (out.empty() ? "" : ",\n") + bold(page_name(page)) + "(1)";
  };
  add(program);
  for (const CommandHelp& below : program.commands) add(below);
  return ".SH SEE ALSO\n" + out + '\n';
}

}  // namespace

std::string man_page(const CommandHelp& program, const std::string& name) {
  const auto found =
      std::ranges::find(program.commands, program.name + ' ' + name, &CommandHelp::name);
  const CommandHelp& command = found == program.commands.end() ? program : *found;
  std::string title = page_name(command);
  for (char& c : title) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  std::string out =
      fmt::format(".TH {} 1 \"\" \"Trivet {}\" \"Trivet\"\n", escaped(title), TRIVET_VERSION);
  out += ".SH NAME\n" + escaped(page_name(command)) + " \\- " +
         escaped(first_line(command.meaning)) + '\n';
  out += ".SH SYNOPSIS\n" + synopsis(command);
  for (const CommandHelp& below : command.commands) {
    if (&command != &program) out += ".PP\n" + synopsis(below);
  }
  if (const std::string text = description(command); !text.empty())
    out += ".SH DESCRIPTION\n" + text;
  if (!command.commands.empty()) out += commands_text(program, command);
  if (const std::string options = options_text(command); !options.empty())
    out += ".SH OPTIONS\n" + options;
  for (const CommandHelp& below : command.commands) {
    if (&command == &program) continue;
    out += ".SH OPTIONS OF " + escaped(below.name) + '\n' + options_text(below);
  }
  if (&command != &program)
    out += ".PP\nOptions of all commands are in " + bold(page_name(program)) + "(1).\n";
  return out + exit_status() + see_also(program, command);
}

}  // namespace trivet::apps
