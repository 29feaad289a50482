/// Improvements that are left out by a value of the options.
#pragma once

#include "engine/recognition/recognize.hpp"

namespace trivet::engine {

/// Set each option whose value is all that an improvement in `options.ablated` does back to what it
/// was before it; the stages ask `ablated` for the others. With none left out the options stay as
/// they are.
RecognizeOptions ablate(RecognizeOptions options);

}  // namespace trivet::engine
