/// Exit codes of commands after sysexits.h, as scripts expect them.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "storage/common/result.hpp"

namespace trivet::apps {

struct ExitCode {
  ErrorCode error;
  int number;
  std::string_view meaning;
};

/// The exit codes of all failures; 0 is success.
inline constexpr std::array<ExitCode, 8> kExitCodes{{
    {ErrorCode::usage, 2, "An option or an argument is wrong."},
    {ErrorCode::bad_data, 65, "A file breaks its format, or cannot be used."},
    {ErrorCode::missing_input, 66, "A file that is named does not exist."},
    {ErrorCode::changed, 69, "A file was changed by others while it was used."},
    {ErrorCode::internal, 70, "A fault of the program."},
    {ErrorCode::cannot_create, 73, "A file or a folder cannot be made."},
    {ErrorCode::io, 74, "Reading or writing failed, or disk or memory ran out."},
    {ErrorCode::resumable, 75, "It was stopped before its end."},
}};

inline int exit_code(ErrorCode error) {
  if (error == ErrorCode::damaged) error = ErrorCode::bad_data;
  if (error == ErrorCode::no_space || error == ErrorCode::no_memory) error = ErrorCode::io;
  return std::ranges::find(kExitCodes, error, &ExitCode::error)->number;
}

}  // namespace trivet::apps
