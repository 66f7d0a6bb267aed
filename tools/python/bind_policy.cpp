// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "policy/policy_file.h"
#include "sim/robot/robot_model.h"
#include "tools/policy/description.h"
#include "tools/policy/policy_import.h"
#include "tools/python/bind.h"
#include "tools/python/environments.h"
#include "tools/train/policy_spec.h"
#include "tools/train/task/leg_modes.h"

namespace sandrunner::python {
namespace {

template <typename Values>
py::array_t<float> float_array(const Values& values, const std::vector<py::ssize_t>& shape) {
  return py::array_t<float>(shape, values.data());
}

std::vector<py::ssize_t> shape_of(const NamedTensor& tensor) {
  return {tensor.shape.begin(), tensor.shape.end()};
}

/// What policy files say besides the weights; `write_policy` takes it back.
py::dict spec_dict(const PolicySpec& spec, float observation_clip) {
  py::dict all;
  all["name"] = spec.name;
  all["joint_names"] = spec.joint_names;
  all["nominal_position_rad"] = spec.nominal_position_rad;
  const JointArray<double>& scale = spec.action_scale_rad;
  all["action_scale_rad"] = has_one_scale(spec) ? py::cast(scale[0]) : py::cast(scale);
  all["action_clip"] = spec.action_clip;
  all["kp_nmprad"] = spec.kp_nmprad;
  all["kd_nmsprad"] = spec.kd_nmsprad;
  all["torque_limit_nm"] = spec.torque_limit_nm;
  all["yaw_command_clip_mps2"] = spec.yaw_command_clip_mps2;
  all["observation_clip"] = observation_clip;
  all["estimate_mean"] = spec.estimate_mean;
  all["estimate_variance"] = spec.estimate_variance;
  all["provenance"] = spec.provenance;
  return all;
}

/// (tensors by name, spec).
py::tuple read(const std::string& path) {
  const std::string_view shipped = shipped_policy_text(path);
  PolicyFile file = shipped.empty() ? read_policy_file(path) : parse_policy_file(shipped, path);
  py::dict tensors;
  for (const NamedTensor& tensor : tensors_of(file.parameters)) {
    tensors[py::str(tensor.name)] = float_array(*tensor.values, shape_of(tensor));
  }
  return py::make_tuple(tensors, spec_dict(file.spec, file.parameters.observation_clip));
}

/// The values of the tensor of this name and shape. Throws InputError.
std::vector<float> values_of(const py::dict& tensors, const NamedTensor& tensor) {
  const char* const name = tensor.name.c_str();
  if (!tensors.contains(name)) {
    throw InputError(
        fmt::format("state_dict: found no '{}', expected it (policy/README.md)", tensor.name));
  }
  const auto array = checked_array<float>(name, tensors[name], shape_of(tensor));
  std::vector<float> values(array.data(), array.data() + array.size());
  const auto bad = std::ranges::find_if_not(values, [](float v) { return std::isfinite(v); });
  if (bad != values.end()) {
    throw InputError(fmt::format("{}: found {}, expected finite numbers", tensor.name, *bad));
  }
  return values;
}

/// Takes the network's tensors from `tensors`. The normalisation stays; where they have one of
/// their own, it must be the same. Throws InputError.
void take_weights(const py::dict& tensors, NetworkParameters& parameters) {
  for (const NamedTensor& tensor : tensors_of(parameters)) {
    if (!tensor.name.starts_with("observation.")) {
      *tensor.values = values_of(tensors, tensor);
      continue;
    }
    if (!tensors.contains(tensor.name.c_str())) continue;
    const std::vector<float> values = values_of(tensors, tensor);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const float is = values[i], expected = (*tensor.values)[i];
      if (std::fabs(is - expected) <= 1e-4f * std::max(std::fabs(expected), 1.0f)) continue;
      throw InputError(fmt::format("{}: found {} at {}, expected {}, as the environment shows it",
                                   tensor.name, is, i, expected));
    }
  }
}

void write(const std::string& path, const py::dict& tensors, const Environments& environments,
           const std::string& name, const std::map<std::string, std::string>& provenance) {
  PolicyFile file;
  const train::TaskConfig& config = environments.config();
  const train::InputScales& scales = environments.task().scales();
  train::set_normalisation(scales, file.parameters);
  take_weights(tensors, file.parameters);
  if (!config.policy.in_joints) {
    train::answer_in_joints(config.policy.mode_gain, file.parameters);
  }
  file.spec =
      train::policy_spec(config, environments.robot(), scales, environments.task().command_range());
  if (!name.empty()) file.spec.name = name;
  file.spec.provenance = provenance;
  file.spec.provenance.emplace("config", environments.effective_settings());
  file.spec.provenance.emplace("robot", environments.robot().description.name);
  file.golden = make_golden_example(file.parameters);
  write_policy_file(path, file);
}

/// A policy for many robots at once: the network of the controller, with a memory for each.
class Policies {
 public:
  explicit Policies(Policy policy) : policy_(std::move(policy)) {}

  const JointArray<std::string>& joint_names() const { return policy_.spec().joint_names; }

  /// (joint targets, raw estimates): rows of `observation`, raw and in SI units. Memories are
  /// cleared first where `reset`.
  py::tuple step(const py::object& observation_array, const py::object& reset_array) {
    const py::ssize_t count =
        py::isinstance<py::array>(observation_array) &&
                py::reinterpret_borrow<py::array>(observation_array).ndim() == 2
            ? py::reinterpret_borrow<py::array>(observation_array).shape(0)
            : static_cast<py::ssize_t>(states_.size());
    const auto observation =
        checked_array<float>("observation", observation_array, {count, kObservationSize});
    const auto reset = checked_array<std::uint8_t>("reset", reset_array, {count});
    if (states_.size() != static_cast<std::size_t>(count)) {
      states_.assign(static_cast<std::size_t>(count), {});
    }
    py::array_t<double> target(std::vector<py::ssize_t>{count, kNumJoints});
    py::array_t<double> estimate(std::vector<py::ssize_t>{count, kEstimateSize});
    for (py::ssize_t i = 0; i < count; ++i) {
      NetworkState& state = states_[static_cast<std::size_t>(i)];
      if (reset.data()[i] != 0) state = {};
      std::array<float, kObservationSize> row;
      std::copy_n(observation.data() + i * kObservationSize, kObservationSize, row.begin());
      const PolicyStep out = policy_.step(row, state);
      std::ranges::copy(out.target_rad, target.mutable_data() + i * kNumJoints);
      double* const e = estimate.mutable_data() + i * kEstimateSize;
      e[0] = out.estimate.body_height_m;
      std::ranges::copy(out.estimate.velocity_mps, e + 1);
      std::ranges::copy(out.estimate.foot_height_m, e + 4);
    }
    return py::make_tuple(target, estimate);
  }

 private:
  Policy policy_;
  std::vector<NetworkState> states_;
};

}  // namespace

void bind_policy(py::module_& module) {
  module.def("read_policy", &read, py::arg("path"));
  module.def("write_policy", &write, py::kw_only(), py::arg("path"), py::arg("tensors"),
             py::arg("environments"), py::arg("name"), py::arg("provenance"));
  module.def(
      "import_policy",
      [](const std::string& input, const std::string& output, const std::string& name,
         const std::string& robot, const std::string& observation,
         const std::vector<std::string>& settings) {
        import_policy({.input = input,
                       .output = output,
                       .name = name,
                       .robot = robot,
                       .observation = observation,
                       .assignments = settings});
      },
      py::kw_only(), py::arg("input"), py::arg("output"), py::arg("name"), py::arg("robot"),
      py::arg("observation"), py::arg("settings"));
  module.def(
      "activation_in",
      [](const std::string& observation, const std::string& robot) {
        const sim::Robot known = sim::load_robot(robot);
        return activation_text(
            read_description(observation, known.description).parameters.activation);
      },
      py::arg("observation"), py::arg("robot"));
  py::class_<Policies>(module, "Policies")
      .def(py::init([](const std::string& path) {
             return Policies(shipped_policy_text(path).empty() ? load_policy(path)
                                                               : load_shipped_policy(path));
           }),
           py::arg("path"))
      .def_property_readonly("joint_names", &Policies::joint_names)
      .def("step", &Policies::step, py::arg("observation"), py::arg("reset"));
}

}  // namespace sandrunner::python
