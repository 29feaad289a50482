/// Calls from Python into the engine: errors as exceptions, work without the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <future>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>

#include "engine/common/progress.hpp"
#include "storage/common/result.hpp"

namespace trivet::python {

namespace py = pybind11;

/// Raises the exception of the error's kind: trivet.errors.
[[noreturn]] void raise(const Error& error);

/// The name of a file, which may be any bytes, as decoded by os.fsdecode().
py::str path_text(const std::string& file);

template <class T>
T unwrap(Result<T> result) {
  if (!result) raise(result.error());
  return *std::move(result);
}
inline void unwrap(const Result<void>& result) {
  if (!result) raise(result.error());
}

/// Whether this thread runs signal handlers.
bool is_main_thread();

/// Runs work(stop token) while other Python threads run. An exception of a signal handler, such as
/// that of Ctrl-C, requests a stop, and is raised when the work has ended. Exceptions of the work
/// are passed on.
template <class Work>
auto interruptibly(Work&& work, std::stop_source stop = {}) {
  if (!is_main_thread()) {
    const py::gil_scoped_release released;
    return work(stop.get_token());
  }
  constexpr std::chrono::milliseconds kHowOften{50};
  std::optional<py::error_already_set> raised;  // by a signal handler
  auto result = [&] {
    const py::gil_scoped_release released;
    auto running = std::async(std::launch::async, [&] { return work(stop.get_token()); });
    while (running.wait_for(kHowOften) == std::future_status::timeout) {
      const py::gil_scoped_acquire held;
      if (raised || PyErr_CheckSignals() == 0) continue;
      raised.emplace();
      stop.request_stop();
    }
    return running.get();
  }();
  if (raised) throw py::error_already_set(std::move(*raised));
  return result;
}

/// Calls the caller's progress(done, total, item). An exception of the callback stops the work, and
/// is raised by `rethrow`. Constructed, used by `to` and destroyed with the lock held.
class Reports {
 public:
  Reports(py::object callback, std::stop_source stop)
      : callback_(std::move(callback)), stop_(std::move(stop)) {}
  /// The Progress for the work, on whose threads it acquires the lock. Without a callback it does
  /// nothing.
  Progress to(std::stop_token stop);
  void rethrow();

 private:
  py::object callback_;
  std::stop_source stop_;
  std::optional<py::error_already_set> raised_;
};

}  // namespace trivet::python
