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

template <typename Record>
py::array records(std::vector<Record>& values, const py::dtype& type, const py::object& owner) {
  return py::array(type, {static_cast<py::ssize_t>(values.size())}, {sizeof(Record)}, values.data(),
                   owner);
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

void set_states(Robots& robots, const py::object& array, const std::vector<int>& indices) {
  const auto rows = rows_of<sim::RobotState<float>>("state", array, state_type(), indices.size());
  const OneAtATime lock(robots.busy());
  for (std::size_t i = 0; i < rows.size(); ++i) robots.set_state(indices[i], rows[i]);
}

void set_models(Robots& robots, const py::object& array, const std::vector<int>& indices) {
  const auto rows = rows_of<sim::RobotModel<float>>("model", array, model_type(), indices.size());
  const OneAtATime lock(robots.busy());
  for (std::size_t i = 0; i < rows.size(); ++i) robots.set_model(indices[i], rows[i]);
}

py::array models(const Robots& robots) {
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
      .def("states",
           [](const py::object& self) {
             return records(self.cast<Robots&>().states(), state_type(), self);
           })
      .def("drives",
           [](const py::object& self) {
             return records(self.cast<Robots&>().drives(), drive_type(), self);
           })
      .def("reports",
           [](const py::object& self) {
             return records(self.cast<Robots&>().reports(), report_type(), self);
           })
      .def("sums",
           [](const py::object& self) {
             return records(self.cast<Robots&>().sums(), sums_type(), self);
           })
      .def("models", &models)
      .def("set_states", &set_states)
      .def("set_models", &set_models)
      .def("set_ground",
           [](Robots& robots, const std::string& ground, const std::vector<std::string>& settings,
              const std::vector<int>& indices) {
             const OneAtATime lock(robots.busy());
             robots.set_ground(ground, settings, indices);
           })
      .def("stand",
           [](Robots& robots, const std::vector<int>& indices) {
             const OneAtATime lock(robots.busy());
             robots.stand(indices);
           })
      .def("advance",
           [](Robots& robots, int ticks) {
             const py::gil_scoped_release release;
             const OneAtATime lock(robots.busy());
             robots.advance(ticks);
           })
      .def_property_readonly("robot_name",
                             [](const Robots& robots) { return robots.robot().description.name; })
      .def_property_readonly("nominal_rad",
                             [](const Robots& robots) { return robots.robot().nominal_rad; });
}

}  // namespace sandrunner::python
