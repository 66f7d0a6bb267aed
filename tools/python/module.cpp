// SPDX-License-Identifier: BSD-3-Clause
// sandrunner._native: the part of the Python package that is C++ (README.md of this folder).
#include "tools/python/bind.h"

namespace {

void translate_input_error(std::exception_ptr error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const sandrunner::InputError& e) {
    PyErr_SetString(PyExc_ValueError, sandrunner::one_line(e.what()).c_str());
  }
}

}  // namespace

PYBIND11_MODULE(_native, module) {
  pybind11::register_exception_translator(&translate_input_error);
  module.attr("__version__") = SANDRUNNER_VERSION;
  sandrunner::python::bind_environments(module);
  sandrunner::python::bind_batch(module);
  sandrunner::python::bind_ground(module);
  sandrunner::python::bind_policy(module);
  sandrunner::python::bind_recorder(module);
  sandrunner::python::bind_bench(module);
}
