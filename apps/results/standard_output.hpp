/// Output of commands to standard output.
#pragma once

#include <string_view>

#include "storage/common/result.hpp"

namespace trivet::apps {

/// Writes a text, escaped by printable_lines(), and flushes it. All output to standard output goes
/// through this function, so that a full disk is reported as an error. Errors: io.
Result<void> write_output(std::string_view text);

}  // namespace trivet::apps
