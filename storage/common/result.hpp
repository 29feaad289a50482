/// A value or an error, with the names of std::expected (absent in C++20).
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "storage/common/precondition.hpp"

namespace trivet {

/// Category of an error; the command line maps each to a sysexits code.
enum class ErrorCode {
  usage,          ///< an option or argument is wrong
  bad_data,       ///< a file or cloud violates its format or cannot be used
  missing_input,  ///< a named input does not exist
  cannot_create,  ///< an output cannot be created
  io,             ///< reading or writing failed
  resumable,      ///< stopped before the end; running again resumes
  internal,       ///< a bug
  changed,        ///< another process changed a file while it was in use
  damaged,        ///< an open library proved to break its format or its checksums
  no_space,       ///< no space to write: a full disk, a quota, a limit on files
  no_memory,      ///< out of memory; may succeed later, or on a larger machine
};

/// Message of no_memory, short enough to need no allocation.
inline constexpr const char* kOutOfMemory = "out of memory";

/// A message that names the file, the location, the expected and found values, and the remedy.
struct Error {
  ErrorCode code;
  std::string message;
};

/// A value or an error. Check has_value() before accessing the value.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit
  Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit

  bool has_value() const noexcept { return content_.index() == 0; }
  explicit operator bool() const noexcept { return has_value(); }

  T& value() & { return get(*this); }
  const T& value() const& { return get(*this); }
  T&& value() && { return std::move(get(*this)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const Error& error() const {
    TRIVET_REQUIRE(!has_value(), "a result that holds an error where its error is asked for");
    return *std::get_if<1>(&content_);
  }

 private:
  template <class Self>
  static auto& get(Self& self) {
    TRIVET_REQUIRE(self.has_value(), "a result that holds a value where its value is asked for");
    return *std::get_if<0>(&self.content_);
  }
  std::variant<T, Error> content_;
};

/// Result of a function without a value: success or an error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT: implicit

  bool has_value() const noexcept { return !error_.has_value(); }
  explicit operator bool() const noexcept { return has_value(); }
  const Error& error() const {
    TRIVET_REQUIRE(error_.has_value(), "a result that holds an error where its error is asked for");
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace trivet

/// End the function with the error of a Result that has one. A value, if any, is ignored.
#define TRIVET_TRY(...)                                                                  \
  do {                                                                                   \
    if (auto&& trivet_tried = (__VA_ARGS__); !trivet_tried) return trivet_tried.error(); \
  } while (false)

/// Declare a variable with the value of a Result, or end the function with its error:
/// TRIVET_TRY_ASSIGN(const Cloud cloud, read_cloud(file));
/// This expands to several statements; put braces around it after an `if`.
#define TRIVET_TRY_ASSIGN(declaration, ...) \
  TRIVET_TRY_ASSIGN_FROM(TRIVET_JOINED(trivet_tried_, __COUNTER__), declaration, __VA_ARGS__)
#define TRIVET_TRY_ASSIGN_FROM(tried, declaration, ...) \
  auto tried = (__VA_ARGS__);                           \
  if (!tried) return tried.error();                     \
  declaration = *std::move(tried)
#define TRIVET_JOINED(first, second) TRIVET_JOINED_AS_THEY_ARE(first, second)
#define TRIVET_JOINED_AS_THEY_ARE(first, second) first##second
