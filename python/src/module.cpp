// The extension module trivet._trivet; the public interface is in python/trivet.
#include <pybind11/pybind11.h>

#include "python/src/evaluate.hpp"
#include "python/src/library.hpp"
#include "python/src/recognize.hpp"
#include "python/src/scan.hpp"
#include "python/src/scene.hpp"
#include "python/src/train.hpp"

PYBIND11_MODULE(_trivet, module) {
  module.attr("__version__") = TRIVET_VERSION;
  trivet::python::add_scene(module);
  trivet::python::add_library(module);
  trivet::python::add_recognize(module);
  trivet::python::add_train(module);
  trivet::python::add_evaluate(module);
  trivet::python::add_scan(module);
}
