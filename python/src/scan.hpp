/// The virtual depth sensor.
#pragma once

#include <pybind11/pybind11.h>

namespace trivet::python {

void add_scan(pybind11::module_& module);

}  // namespace trivet::python
