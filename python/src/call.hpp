/// Between Python's calls and the engine's: errors as exceptions, work without the interpreter's lock.
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

/// The exception of its kind: trivet.errors.
[[noreturn]] void raise(const Error& error);

/// The name of a file, which is any bytes, as os.fsdecode() has it.
py::str path_text(const std::string& file);

template <class T>
T unwrap(Result<T> result) {
  if (!result) raise(result.error());
  return *std::move(result);
}
inline void unwrap(const Result<void>& result) {
  if (!result) raise(result.error());
}

/// Whether signals reach this thread.
bool is_main_thread();

/// Do work(stop token) while other Python threads run; what the handler of a signal raises, as of
/// Ctrl-C, asks it to stop, and is raised when it has ended. What the work throws is thrown.
template <class Work>
auto interruptibly(Work&& work, std::stop_source stop = {}) {
  if (!is_main_thread()) {
    const py::gil_scoped_release released;
    return work(stop.get_token());
  }
  constexpr std::chrono::milliseconds kHowOften{50};
  std::optional<py::error_already_set> raised;  // by the handler of a signal
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

/// What a caller wants to be told: progress(done, total, item). What it raises stops the work, and
/// is raised by `rethrow`. Made, used by `to` and destroyed with the lock held.
class Reports {
 public:
  Reports(py::object callback, std::stop_source stop)
      : callback_(std::move(callback)), stop_(std::move(stop)) {}
  /// For the work, on whose threads it takes the lock; nothing is told where there is no callback.
  Progress to(std::stop_token stop);
  void rethrow();

 private:
  py::object callback_;
  std::stop_source stop_;
  std::optional<py::error_already_set> raised_;
};

}  // namespace trivet::python
