/// Recognition in one scene, and its results.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <stop_token>

#include "engine/recognition/recognize.hpp"

namespace trivet::python {

/// Stops the work that uses it, from any thread.
struct Stopper {
  std::stop_source source;
};

/// The preset, overridden by the keywords. Raises UsageError.
RecognizeOptions recognize_options(const std::string& preset, const pybind11::dict& keywords);

void add_recognize(pybind11::module_& module);

}  // namespace trivet::python
