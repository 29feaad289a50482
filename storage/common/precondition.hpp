/// Preconditions that protect memory and results, checked in every build. Data from files and
/// clients is checked on entry. Preconditions catch a forgotten check, so that a bug ends one job
/// with an error rather than the process, and never gives a wrong answer.
#pragma once

#include <stdexcept>
#include <string>

namespace trivet {

/// A function was called with invalid arguments: a bug of this program.
class BrokenPrecondition : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Out of line, so that a check costs one comparison and a jump that is not taken.
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
/// end the process. Not for expected failures, which are Results.
///
/// expected  the expected condition in words, as in "one normal a point"
#define TRIVET_REQUIRE(condition, expected) \
  (static_cast<bool>(condition)             \
       ? void()                             \
       : ::trivet::throw_broken_precondition(__FILE_NAME__, __LINE__, #condition, expected))
