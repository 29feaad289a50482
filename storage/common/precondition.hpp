/// Preconditions that protect memory and what is computed, checked in every build. What files and
/// clients send is checked where it enters; these hold where such a check was forgotten, so that a
/// bug ends one job with an error and not the process, or worse, with a wrong answer.
#pragma once

#include <stdexcept>
#include <string>

namespace trivet {

/// A function was called with what it does not take: a bug of this program.
class BrokenPrecondition : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Out of line, so that a check costs a comparison and a jump that is never taken.
[[noreturn, gnu::cold, gnu::noinline]] inline void throw_broken_precondition(const char* file,
                                                                             int line,
                                                                             const char* condition,
                                                                             const char* expected) {
  throw BrokenPrecondition(std::string("a bug of this program: expected ") + expected + " (" +
                           condition + ", " + file + ":" + std::to_string(line) +
                           "); please report it with the input that led to it");
}

}  // namespace trivet

/// Throw BrokenPrecondition unless the condition holds. Not for noexcept functions, where it would
/// end the process; nor for what is expected to happen, which is a Result.
///
/// expected  words for what should have been, as in "one normal a point"
#define TRIVET_REQUIRE(condition, expected) \
  (static_cast<bool>(condition)             \
       ? void()                             \
       : ::trivet::throw_broken_precondition(__FILE_NAME__, __LINE__, #condition, expected))
