/// Objects behind the handles, and the boundary that no exception crosses.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <stop_token>
#include <string_view>
#include <vector>

#include "c/trivet.h"
#include "engine/recognition/recognize.hpp"
#include "storage/common/valid_text.hpp"

struct trivet_library {
  trivet::Recognizer recognizer;
};

struct trivet_result {
  trivet::SceneResult scene;
  std::vector<std::uint32_t> models;  ///< index in the library, by detection
};

struct trivet_stopper {
  std::stop_source source;
};

namespace trivet::c {

/// Write status and message to the caller's error, if there is one.
inline trivet_status set_error(trivet_status status, std::string_view message,
                               trivet_error* error) noexcept {
  if (!error) return status;
  constexpr std::size_t kMost = sizeof(error->message) - 1;
  std::size_t size = std::min(message.size(), kMost);
  // Do not cut within a UTF-8 character.
  while (size < message.size() && size > 0 && (message[size] & 0xC0) == 0x80) --size;
  std::copy_n(message.data(), size, error->message);
  error->message[size] = '\0';
  error->status = status;
  return status;
}

constexpr trivet_status status_of(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::usage:
      return TRIVET_USAGE;
    case ErrorCode::bad_data:
    case ErrorCode::damaged:
      return TRIVET_BAD_DATA;
    case ErrorCode::missing_input:
      return TRIVET_MISSING_INPUT;
    case ErrorCode::cannot_create:
      return TRIVET_CANNOT_CREATE;
    case ErrorCode::io:
    case ErrorCode::no_space:
    case ErrorCode::no_memory:
      return TRIVET_IO;
    case ErrorCode::resumable:
      return TRIVET_STOPPED;
    case ErrorCode::changed:
      return TRIVET_CHANGED;
    case ErrorCode::internal:
      return TRIVET_INTERNAL;
  }
  return TRIVET_INTERNAL;
}

/// Return the object created by `make` to the caller, or the error.
///
/// out   receives a new T, or null
/// make  () -> Result<std::unique_ptr<T>>
template <class T, class Make>
trivet_status hand_out(T** out, trivet_error* error, Make&& make) noexcept {
  if (!out) return set_error(TRIVET_USAGE, "expected a place for the result, found null", error);
  *out = nullptr;
  try {
    Result<std::unique_ptr<T>> made = make();
    if (!made)
      return set_error(status_of(made.error().code), printable_lines(made.error().message), error);
    *out = made->release();
    return set_error(TRIVET_OK, "", error);
  } catch (const std::bad_alloc&) {
    return set_error(TRIVET_IO, kOutOfMemory, error);
  } catch (const std::exception& fault) {
    return set_error(TRIVET_INTERNAL, fault.what(), error);
  } catch (...) {
    return set_error(TRIVET_INTERNAL, "a fault of unknown kind", error);
  }
}

}  // namespace trivet::c
