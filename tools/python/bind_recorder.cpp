// SPDX-License-Identifier: BSD-3-Clause
#include "tools/python/bind.h"
#include "tools/python/recorder.h"

namespace sandrunner::python {

void bind_recorder(py::module_& module) {
  py::class_<Recorder>(module, "Recorder")
      .def(py::init<Environments&, int>(), py::keep_alive<1, 2>(), py::arg("environments"),
           py::arg("env"))
      .def("add", &Recorder::add)
      .def("write", &Recorder::write, py::arg("path"), py::arg("title"));
}

}  // namespace sandrunner::python
