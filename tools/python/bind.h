// SPDX-License-Identifier: BSD-3-Clause
// The parts of the Python module, each from a file of its own, and what they share. All arguments
// are checked in C++, so that no call from Python can crash; `InputError` becomes ValueError.
#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "rt/base/errors.h"

namespace sandrunner::python {

namespace py = pybind11;

void bind_environments(py::module_& module);
void bind_batch(py::module_& module);
void bind_ground(py::module_& module);
void bind_policy(py::module_& module);
void bind_recorder(py::module_& module);
void bind_bench(py::module_& module);

inline std::string text_of(py::handle object) { return py::cast<std::string>(py::str(object)); }

/// "(1024, 12)".
inline std::string shape_text(const py::ssize_t* shape, std::size_t dimensions) {
  std::string text;
  for (std::size_t i = 0; i < dimensions; ++i) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", shape[i]);
  }
  return fmt::format("({}{})", text, dimensions == 1 ? "," : "");
}

/// `array` with rows next to each other, if it has this shape and holds T. Throws InputError.
template <typename T>
py::array_t<T, py::array::c_style> checked_array(const char* name, const py::object& object,
                                                 const std::vector<py::ssize_t>& shape) {
  if (!py::isinstance<py::array>(object)) {
    throw InputError(fmt::format("{}: found {}, expected a numpy array", name,
                                 text_of(py::type::of(object).attr("__name__"))));
  }
  const auto array = py::reinterpret_borrow<py::array>(object);
  const auto expected = py::dtype::of<T>();
  if (!array.dtype().equal(expected)) {
    throw InputError(fmt::format("{}: found dtype {}, expected {}", name, text_of(array.dtype()),
                                 text_of(expected)));
  }
  const auto dimensions = static_cast<std::size_t>(array.ndim());
  if (!std::equal(array.shape(), array.shape() + dimensions, shape.begin(), shape.end())) {
    throw InputError(fmt::format("{}: found shape {}, expected {}", name,
                                 shape_text(array.shape(), dimensions),
                                 shape_text(shape.data(), shape.size())));
  }
  auto rows = py::array_t<T, py::array::c_style>::ensure(array);
  if (!rows) throw InputError(fmt::format("{}: found no memory to put its rows together", name));
  return rows;
}

/// Rows of numbers that live as long as `owner` does, which they keep alive.
template <typename T>
py::array_t<T> view_of(T* data, const std::vector<py::ssize_t>& shape, const py::object& owner) {
  return py::array_t<T>(shape, data, owner);
}

}  // namespace sandrunner::python
