#include "python/src/options.hpp"

#include <pybind11/stl.h>

#include <limits>
#include <vector>

namespace trivet::python {
namespace {

OptionValue number_of(const OptionInfo& info, const py::handle& value) {
  if (value.is_none()) {
    if (info.automatic) return std::string("auto");
    return std::numeric_limits<double>::infinity();
  }
  if (py::isinstance<py::str>(value)) return unwrap(parse_option(info, value.cast<std::string>()));
  return value.cast<double>();
}

const char* wanted(OptionKind kind) {
  switch (kind) {
    case OptionKind::flag:
      return "True or False";
    case OptionKind::number:
      return "a number";
    case OptionKind::count:
      return "a whole number";
    case OptionKind::choice:
      return "a name";
    case OptionKind::numbers:
      return "a sequence of numbers";
    case OptionKind::names:
      return "a sequence of names";
  }
  return "";
}

}  // namespace

OptionValue value_of(const OptionInfo& info, const py::handle& value) {
  try {
    switch (info.kind) {
      case OptionKind::flag:
        return value.cast<bool>();
      case OptionKind::number:
      case OptionKind::count:
        return number_of(info, value);
      case OptionKind::choice:
        return value.cast<std::string>();
      case OptionKind::numbers:
        if (value.is_none()) return std::vector<double>();
        return py::cast<std::vector<double>>(py::module_::import("builtins").attr("list")(value));
      case OptionKind::names:
        if (value.is_none()) return std::vector<std::string>();
        if (py::isinstance<py::str>(value)) return std::vector{value.cast<std::string>()};
        return py::cast<std::vector<std::string>>(
            py::module_::import("builtins").attr("list")(value));
    }
  } catch (const py::cast_error&) {
  }
  raise(named(info, {ErrorCode::usage, fmt::format("expected {}, found {}", wanted(info.kind),
                                                   py::repr(value).cast<std::string>())}));
}

// An unset value is None.
py::object object_of(const OptionValue& value) {
  if (is_unset(value)) return py::none();
  return std::visit([](const auto& one) { return py::cast(one); }, value);
}

}  // namespace trivet::python
