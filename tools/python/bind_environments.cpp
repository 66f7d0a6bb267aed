// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <memory>

#include "tools/python/bind.h"
#include "tools/python/environments.h"
#include "tools/python/one_at_a_time.h"

namespace sandrunner::python {
namespace {

/// Views of all arrays that a step writes, by name.
py::dict arrays(const py::object& self) {
  auto& e = self.cast<Environments&>();
  const py::ssize_t n = e.envs();
  learner::Rollout& r = e.rollout();
  py::dict views;
  const auto rows = [&](const char* name, auto block) {
    views[name] = view_of(block.data(), {n, block.rows()}, self);
  };
  rows("observation", r.observation(1));
  rows("privileged", r.privileged(1));
  rows("estimate_target", r.estimate_target(1));
  rows("final_privileged", r.final_privileged(0));
  views["final_observation"] =
      view_of(e.details().final_observation.front().data(), {n, kObservationSize}, self);
  views["reward_terms"] = view_of(e.details().terms.front().data(),
                                  {n, static_cast<py::ssize_t>(train::kRewardTerms)}, self);
  views["reward"] = view_of(&r.reward(0, 0), {n}, self);
  views["reset"] = view_of(&r.reset(1, 0), {n}, self);
  views["terminated"] = view_of(e.terminated().data(), {n}, self);
  views["truncated"] = view_of(e.truncated().data(), {n}, self);
  views["ended"] = view_of(e.ended().data(), {n}, self);
  return views;
}

void step(Environments& e, const py::object& actions) {
  const auto array = checked_array<float>("actions", actions, {e.envs(), kNumJoints});
  const float* const data = array.data();
  const OneAtATime lock(e.busy());
  const py::gil_scoped_release release;
  e.step(data);
}

py::dict progress(Environments& e) {
  const OneAtATime lock(e.busy());
  const Progress p = e.progress();
  py::dict all;
  all["speed_mps"] = p.curriculum.speed_mps;
  all["ground"] = p.curriculum.ground;
  all["transitions"] = p.transitions;
  all["late"] = p.late;
  return all;
}

void set_progress(Environments& e, double speed_mps, double ground, double transitions,
                  double late) {
  const auto check = [](const char* name, double found, double most) {
    if (found >= 0.0 && found <= most) return;
    throw InputError(fmt::format("curriculum: found {} = {}, expected a number from 0 to {}", name,
                                 found, most));
  };
  check("speed_mps", speed_mps, 100.0);
  check("ground", ground, 1.0);
  check("transitions", transitions, 1e13);
  check("late", late, 1.0);
  const OneAtATime lock(e.busy());
  e.set_progress({{speed_mps, ground}, transitions, late});
}

/// Means of the latest window, as in the learning curve of sandrunner-train.
py::dict statistics(Environments& e) {
  const OneAtATime lock(e.busy());
  const train::WindowStats& w = e.window();
  py::dict all;
  all["reward"] = w.reward;
  const char* const kinds[] = {"hard", "soft"};
  for (std::size_t k = 0; k < 2; ++k) {
    const std::string kind = kinds[k];
    all[py::str("velocity_kernel_" + kind)] = w.kernel[k];
    all[py::str("falls_per_4s_" + kind)] = w.falls[k];
    all[py::str("speed_ratio_" + kind)] = w.speed_ratio[k];
  }
  all["body_height_m"] = w.body_height_m;
  all["power_w"] = w.power_w;
  all["stride_hz"] = w.stride_hz;
  all["abreast"] = w.abreast;
  all["diagonal"] = w.diagonal;
  const std::vector<std::string> names = train::reward_term_names();
  for (std::size_t i = 0; i < names.size(); ++i) all[py::str(names[i])] = w.terms[i];
  return all;
}

py::dict scales(const Environments& e) {
  const train::InputScales& s = e.task().scales();
  const auto array = [](const auto& values) {
    return py::array_t<float>(static_cast<py::ssize_t>(values.size()), values.data());
  };
  py::dict all;
  all["mean"] = array(s.mean);
  all["inverse_deviation"] = array(s.inverse_deviation);
  all["estimate_mean"] = array(s.estimate_mean);
  all["estimate_deviation"] = array(s.estimate_deviation);
  all["clip"] = s.clip;
  return all;
}

}  // namespace

void bind_environments(py::module_& module) {
  py::class_<Environments>(module, "Environments")
      .def(py::init([](const std::string& robot, int envs, std::uint64_t seed, int threads,
                       const std::string& config_file, const std::vector<std::string>& settings,
                       bool in_joints, int width) {
             const py::gil_scoped_release release;
             return std::make_unique<Environments>(EnvironmentsOptions{
                 robot, envs, seed, threads, config_file, settings, in_joints, width});
           }),
           py::kw_only(), py::arg("robot"), py::arg("envs"), py::arg("seed"), py::arg("threads"),
           py::arg("config_file"), py::arg("settings"), py::arg("in_joints"), py::arg("width"))
      .def("arrays", &arrays)
      .def("step", &step, py::arg("actions"))
      .def("restart", alone_for_long(&Environments::restart), py::arg("seed"))
      .def("set_moves", alone(&Environments::set_moves))
      .def("progress", &progress)
      .def("set_progress", &set_progress, py::kw_only(), py::arg("speed_mps"), py::arg("ground"),
           py::arg("transitions"), py::arg("late"))
      .def("statistics", &statistics)
      .def("scales", &scales)
      .def_property_readonly("effective_settings", &Environments::effective_settings)
      .def_property_readonly("window_steps", &Environments::window_steps)
      .def_property_readonly(
          "observation_clip",
          [](const Environments& e) { return e.config().policy.observation_clip; })
      .def_property_readonly("action_clip",
                             [](const Environments& e) { return e.config().policy.action_clip; })
      .def_property_readonly(
          "action_scale_rad",
          [](const Environments& e) { return e.config().policy.action_scale_rad; })
      .def_property_readonly("robot_name",
                             [](const Environments& e) { return e.robot().description.name; })
      .def_property_readonly("nominal_rad",
                             [](const Environments& e) { return e.robot().nominal_rad; })
      .def_property_readonly("episode_length_s",
                             [](const Environments& e) { return e.config().episode.length_s; })
      .def_property_readonly(
          "joint_names", [](const Environments& e) { return e.robot().description.joint_names; });
  module.def("reward_term_names", &train::reward_term_names);
  module.attr("step_s") = 1.0 / kPolicyHz;
}

}  // namespace sandrunner::python
