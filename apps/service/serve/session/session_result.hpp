/// Results of a session: a value, or the reason of a refusal.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "apps/service/serve/session/session_contents.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps::service {

enum class SessionFault : std::uint8_t {
  failed,     ///< error of the disk, or of reading the request: see its code
  invalid,    ///< name or unit that no scan of the session can have
  unknown,    ///< no such scan, run or answer
  exists,     ///< this name already exists
  stale,      ///< the present version is not the one to be replaced
  too_large,  ///< more than the limit of a session
  full,       ///< more than the rest of the limit
};

/// A scan stored by the session.
struct KeptScan {
  std::string name;
  std::uint64_t num_bytes = 0;
  LengthUnit unit = LengthUnit::meter;
  SessionScan scan;
};

/// An answer stored by the session.
struct KeptAnswer {
  std::string version;
  nlohmann::ordered_json document;  ///< null: its file cannot be read
};

struct SessionError {
  SessionFault fault = SessionFault::failed;
  Error error;
  // Present state in place of the expected version:
  std::optional<KeptScan> kept_scan{};
  std::optional<KeptAnswer> kept_answer{};
};

/// The counterpart of Result with the faults of a session.
template <class T>
class [[nodiscard]] SessionResult {
  using Value = std::conditional_t<std::is_void_v<T>, std::monostate, T>;

 public:
  SessionResult() requires std::is_void_v<T> {}
  SessionResult(Value value)  // NOLINT: implicit
      : content_(std::in_place_index<0>, std::move(value)) {}
  SessionResult(SessionError error)  // NOLINT: implicit
      : content_(std::in_place_index<1>, std::move(error)) {}
  SessionResult(Error error)  // NOLINT: implicit
      : SessionResult(SessionError{SessionFault::failed, std::move(error)}) {}

  explicit operator bool() const noexcept { return content_.index() == 0; }
  Value& operator*() & { return std::get<0>(content_); }
  const Value& operator*() const& { return std::get<0>(content_); }
  Value&& operator*() && { return std::get<0>(std::move(content_)); }
  const SessionError& error() const { return std::get<1>(content_); }

 private:
  std::variant<Value, SessionError> content_;
};

}  // namespace trivet::apps::service
