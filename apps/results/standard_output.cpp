#include "apps/results/standard_output.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace trivet::apps {

Result<void> write_output(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
    return {};
  return Error{ErrorCode::io,
               fmt::format("standard output: cannot be written: {}", std::strerror(errno))};
}

}  // namespace trivet::apps
