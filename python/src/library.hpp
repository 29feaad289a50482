/// An opened library, and its models as arrays.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "apps/inputs/open_recognizer.hpp"
#include "engine/loaded_library/recognizer.hpp"

namespace trivet::python {

/// Shared by all objects that refer to its memory.
struct OpenLibrary {
  std::shared_ptr<const Recognizer> recognizer;
  std::string file;
  apps::OpenOptions opening;

  const Library& library() const { return recognizer->library(); }
};

void add_library(pybind11::module_& module);

}  // namespace trivet::python
