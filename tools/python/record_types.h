// SPDX-License-Identifier: BSD-3-Clause
// The simulator's structs as numpy's structured types, so that arrays of them are what C++ reads.
#pragma once

#include <cstddef>
#include <string>

#include "sim/batch/batch.h"
#include "tools/python/bind.h"

namespace sandrunner::python {

/// Describes a struct of numbers of type S field by field.
template <typename S>
class RecordType {
 public:
  explicit RecordType(std::size_t size) : size_(size) {}

  /// A field of `count` numbers at this offset; 1: a number by itself.
  RecordType& add(const char* name, std::size_t offset, std::size_t count = 1) {
    const char* const number = sizeof(S) == 4 ? "f4" : "f8";
    return add(name, offset,
               count == 1 ? py::object(py::str(number))
                          : py::object(py::str(fmt::format("({},){}", count, number))));
  }
  /// A field of rows x columns numbers.
  RecordType& add_table(const char* name, std::size_t offset, std::size_t rows,
                        std::size_t columns) {
    return add(name, offset,
               py::str(fmt::format("({},{}){}", rows, columns, sizeof(S) == 4 ? "f4" : "f8")));
  }
  /// A field that is a struct, or `count` of them.
  RecordType& add_struct(const char* name, std::size_t offset, const py::dtype& type,
                         std::size_t count = 1) {
    return add(name, offset,
               count == 1 ? py::object(type) : py::object(py::make_tuple(type, count)));
  }
  py::dtype dtype() const {
    return py::dtype(names_, formats_, offsets_, static_cast<py::ssize_t>(size_));
  }

 private:
  RecordType& add(const char* name, std::size_t offset, const py::object& format) {
    names_.append(name);
    formats_.append(format);
    offsets_.append(offset);
    return *this;
  }

  std::size_t size_;
  py::list names_, formats_, offsets_;
};

/// FootContact<S>, whose members are all S.
template <typename S>
py::dtype contact_type() {
  using C = sim::FootContact<S>;
  return RecordType<S>(sizeof(C))
      .add("active", offsetof(C, active))
      .add("region", offsetof(C, region))
      .add("velocity", offsetof(C, velocity))
      .add("memory_depth", offsetof(C, memory_depth))
      .add("memory_position", offsetof(C, memory_x), 2)
      .add("memory_travel", offsetof(C, memory_travel))
      .add("restart_flat", offsetof(C, restart_flat))
      .add("filter", offsetof(C, filter))
      .add("force", offsetof(C, force))
      .add("stroke_latched", offsetof(C, stroke_latched))
      .add("stroke_position", offsetof(C, stroke_x), 2)
      .add("stroke_depth", offsetof(C, stroke_depth))
      .add("stroke_travel", offsetof(C, stroke_travel))
      .dtype();
}

py::dtype state_type();
py::dtype model_type();
py::dtype drive_type();
py::dtype report_type();
py::dtype sums_type();

}  // namespace sandrunner::python
