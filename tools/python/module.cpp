// SPDX-License-Identifier: BSD-3-Clause
// sandrunner._native: the part of the Python package that is C++ (README.md of this folder).
#include <algorithm>
#include <string_view>

#include "tools/python/bind.h"

namespace {

// A message that begins with a program's option names the argument instead.
std::string in_python(const std::string& message) {
  constexpr std::string_view kSet = "--set ", kTerrain = "--terrain: ";
  if (message.starts_with(kTerrain)) return "ground: " + message.substr(kTerrain.size());
  if (!message.starts_with(kSet)) return message;
  const std::size_t end = std::min(message.find(": "), message.size());
  const std::string path = message.substr(kSet.size(), end - kSet.size());
  const bool twice = message.find(path, end) != std::string::npos;
  return "settings: " + message.substr(twice ? end + 2 : kSet.size());
}

void translate_input_error(std::exception_ptr error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const sandrunner::InputError& e) {
    PyErr_SetString(PyExc_ValueError, in_python(sandrunner::one_line(e.what())).c_str());
  }
}

}  // namespace

PYBIND11_MODULE(_native, module) {
  pybind11::register_exception_translator(&translate_input_error);
  sandrunner::python::bind_environments(module);
  sandrunner::python::bind_batch(module);
  sandrunner::python::bind_ground(module);
  sandrunner::python::bind_policy(module);
  sandrunner::python::bind_recorder(module);
  sandrunner::python::bind_bench(module);
}
