/// What commands answer, to standard output.
#pragma once

#include <string_view>

#include "storage/common/result.hpp"

namespace trivet::apps {

/// Write a text, as printable_lines() tells it, and see it leave the process. Everything that goes to standard output goes this
/// way, so that a full disk does not pass for a good run. Errors: io.
Result<void> write_output(std::string_view text);

}  // namespace trivet::apps
