#include "python/src/call.hpp"

#include <string>

#include "storage/common/valid_text.hpp"

namespace trivet::python {

void raise(const Error& error) {
  const char* const name = [&] {
    switch (error.code) {
      case ErrorCode::usage:
        return "UsageError";
      case ErrorCode::bad_data:
      case ErrorCode::damaged:
        return "DataError";
      case ErrorCode::missing_input:
        return "MissingInputError";
      case ErrorCode::cannot_create:
        return "CannotCreateError";
      case ErrorCode::io:
      case ErrorCode::no_space:
      case ErrorCode::no_memory:
        return "InputOutputError";
      case ErrorCode::resumable:
        return "Stopped";
      case ErrorCode::changed:
        return "ChangedError";
      case ErrorCode::internal:
        break;
    }
    return "InternalError";
  }();
  const py::object kind = py::module_::import("trivet.errors").attr(name);
  PyErr_SetObject(kind.ptr(), kind(printable_lines(error.message)).ptr());
  throw py::error_already_set();
}

py::str path_text(const std::string& file) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeFSDefaultAndSize(file.data(), static_cast<py::ssize_t>(file.size())));
}

bool is_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

Progress Reports::to(std::stop_token stop) {
  Progress progress{{}, std::move(stop)};
  if (callback_.is_none()) return progress;
  progress.report = [this](std::size_t done, std::size_t total, std::string_view item) {
    const py::gil_scoped_acquire held;
    if (raised_) return;
    try {
      callback_(done, total, valid_utf8(item));
    } catch (py::error_already_set& raised) {
      raised_.emplace(std::move(raised));
      stop_.request_stop();
    }
  };
  return progress;
}

void Reports::rethrow() {
  if (raised_) throw py::error_already_set(std::move(*raised_));
}

}  // namespace trivet::python
