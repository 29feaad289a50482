/// Training of libraries.
#pragma once

#include <pybind11/pybind11.h>

namespace trivet::python {

void add_train(pybind11::module_& module);

}  // namespace trivet::python
