// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <cmath>
#include <cstring>

#include "sim/ground/terrain_description.h"
#include "tools/python/bind.h"
#include "tools/python/feet.h"
#include "tools/python/record_types.h"

namespace sandrunner::python {
namespace {

using Contact = sim::FootContact<double>;

py::dtype force_type() {
  return RecordType<double>(sizeof(FootForce))
      .add("normal", offsetof(FootForce, normal))
      .add("raw", offsetof(FootForce, raw))
      .add("friction_bound", offsetof(FootForce, friction_bound))
      .add("stroke", offsetof(FootForce, stroke_x), 2)
      .dtype();
}

py::array contacts(py::ssize_t count) {
  if (count < 1 || count > 1 << 24) {
    throw InputError(fmt::format("feet: found {}, expected 1 to {}", count, 1 << 24));
  }
  const std::vector<Contact> fresh(static_cast<std::size_t>(count));
  return py::array(contact_type<double>(), {count}, {sizeof(Contact)}, fresh.data());
}

/// The memory of an array of contacts, which the step changes. Throws InputError.
Contact* checked_contacts(py::array& array) {
  if (!array.dtype().equal(contact_type<double>()) || array.ndim() != 1) {
    throw InputError("contacts: found another array, expected one of Ground.contacts()");
  }
  if (!array.writeable() || array.shape(0) < 1 || array.strides(0) != sizeof(Contact)) {
    throw InputError("contacts: found rows apart or read-only, expected all of Ground.contacts()");
  }
  auto* const rows = static_cast<Contact*>(array.mutable_data());
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    const double region = rows[i].region;
    if (region >= 0.0 && region < sim::kMaxRegions && region == std::floor(region)) continue;
    throw InputError(fmt::format("contacts: found region {} at foot {}, expected 0 to {}", region,
                                 i, sim::kMaxRegions - 1));
  }
  return rows;
}

void require_finite(const char* name, const double* values, py::ssize_t rows) {
  for (py::ssize_t i = 0; i < 3 * rows; ++i) {
    if (std::isfinite(values[i])) continue;
    throw InputError(fmt::format("{}: found {} at [{}, {}], expected finite numbers", name,
                                 values[i], i / 3, i % 3));
  }
}

py::array step_feet(const Feet& feet, py::array contact_array, const py::object& position_array,
                    const py::object& velocity_array, double step_s) {
  Contact* const contact = checked_contacts(contact_array);
  const py::ssize_t count = contact_array.shape(0);
  const auto position = checked_array<double>("position", position_array, {count, 3});
  const auto velocity = checked_array<double>("velocity", velocity_array, {count, 3});
  require_finite("position", position.data(), count);
  require_finite("velocity", velocity.data(), count);
  if (!(step_s >= 1e-6 && step_s <= 0.01)) {
    throw InputError(fmt::format("step_s: found {}, expected 1e-6 to 0.01", step_s));
  }
  py::array forces(force_type(), std::vector<py::ssize_t>{count});
  feet.step(static_cast<std::size_t>(count), position.data(), velocity.data(), step_s, contact,
            static_cast<FootForce*>(forces.mutable_data()));
  return forces;
}

}  // namespace

void bind_ground(py::module_& module) {
  py::class_<Feet>(module, "Feet")
      .def(py::init([](const std::string& ground, const std::vector<std::string>& settings,
                       double radius_m, double width_m, double length_m, int patches) {
             return Feet(ground, settings, {radius_m, width_m, length_m, patches});
           }),
           py::kw_only(), py::arg("ground"), py::arg("settings"), py::arg("foot_radius_m"),
           py::arg("foot_width_m"), py::arg("foot_length_m"), py::arg("foot_patches"))
      .def("step", &step_feet);
  module.def("contacts", &contacts);
  module.def("terrain_preset_names", &sim::terrain_preset_names);
}

}  // namespace sandrunner::python
