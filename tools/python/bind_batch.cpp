// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <cstring>
#include <memory>

#include "tools/python/bind.h"
#include "tools/python/one_at_a_time.h"
#include "tools/python/record_types.h"
#include "tools/python/robots.h"

namespace sandrunner::python {
namespace {

/// The method's rows as an array of numpy, which keeps the robots alive.
template <typename Record>
auto records(std::vector<Record>& (Robots::*method)(), py::dtype (*type)()) {
  return [=](const py::object& self) {
    std::vector<Record>& rows = (self.cast<Robots&>().*method)();
    return py::array(type(), {static_cast<py::ssize_t>(rows.size())}, {sizeof(Record)}, rows.data(),
                     self);
  };
}

/// Copies the rows of an array of this type; throws InputError for another type or count.
template <typename Record>
std::vector<Record> rows_of(const char* name, const py::object& object, const py::dtype& type,
                            std::size_t count) {
  if (!py::isinstance<py::array>(object)) {
    throw InputError(fmt::format("{}: found no array, expected one of {} rows", name, count));
  }
  auto array = py::reinterpret_borrow<py::array>(object);
  if (!array.dtype().equal(type)) {
    throw InputError(fmt::format("{}: found another dtype, expected that of batch.{}", name, name));
  }
  if (array.ndim() != 1 || static_cast<std::size_t>(array.shape(0)) != count) {
    throw InputError(fmt::format("{}: found shape {}, expected ({},)", name,
                                 shape_text(array.shape(), static_cast<std::size_t>(array.ndim())),
                                 count));
  }
  std::vector<Record> rows(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(&rows[i], array.data(static_cast<py::ssize_t>(i)), sizeof(Record));
  }
  return rows;
}

/// The method, which takes a robot and its row, for an array of rows and the robots' indices.
template <typename Record>
auto for_each_row(void (Robots::*method)(int, const Record&), const char* name,
                  py::dtype (*type)()) {
  return [=](Robots& robots, const py::object& array, const std::vector<int>& indices) {
    const auto rows = rows_of<Record>(name, array, type(), indices.size());
    const OneAtATime lock(robots.busy());
    for (std::size_t i = 0; i < rows.size(); ++i) (robots.*method)(indices[i], rows[i]);
  };
}

py::array models(Robots& robots) {
  const OneAtATime lock(robots.busy());
  const auto all = robots.models();
  return py::array(model_type(), {static_cast<py::ssize_t>(all.size())},
                   {sizeof(sim::RobotModel<float>)}, all.data());
}

}  // namespace

void bind_batch(py::module_& module) {
  py::class_<Robots>(module, "Robots")
      .def(py::init<const std::string&, int, const std::string&, const std::vector<std::string>&,
                    double, int>(),
           py::kw_only(), py::arg("robot"), py::arg("count"), py::arg("ground"),
           py::arg("settings"), py::arg("step_hz"), py::arg("threads"))
      .def("states", records(&Robots::states, &state_type))
      .def("drives", records(&Robots::drives, &drive_type))
      .def("reports", records(&Robots::reports, &report_type))
      .def("sums", records(&Robots::sums, &sums_type))
      .def("models", &models)
      .def("set_states", for_each_row(&Robots::set_state, "state", &state_type))
      .def("set_models", for_each_row(&Robots::set_model, "model", &model_type))
      .def("set_ground", alone(&Robots::set_ground))
      .def("stand", alone(&Robots::stand))
      .def("advance", alone_for_long(&Robots::advance))
      .def_property_readonly("robot_name",
                             [](const Robots& robots) { return robots.robot().description.name; })
      .def_property_readonly("nominal_rad",
                             [](const Robots& robots) { return robots.robot().nominal_rad; });
}

}  // namespace sandrunner::python
