/// Comparison of results with the truth of a manifest.
#pragma once

#include <pybind11/pybind11.h>

namespace trivet::python {

void add_evaluate(pybind11::module_& module);

}  // namespace trivet::python
