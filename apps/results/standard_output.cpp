#include "apps/results/standard_output.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <string>

#include "storage/common/valid_text.hpp"
#include "storage/files/errno_text.hpp"

namespace trivet::apps {

Result<void> write_output(std::string_view any) {
  const std::string text = printable_lines(any);
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
    return {};
  return Error{write_error(errno, ErrorCode::io),
               fmt::format("standard output: cannot be written: {}", errno_text())};
}

}  // namespace trivet::apps
