// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/process_config.h"

#include <fmt/format.h>

#include <algorithm>

#include "rt/base/errors.h"
#include "rt/run/robot_drivers.h"

namespace sandrunner {
namespace {

/// `recorded`: what was run once may be read that no run is to have any more.
void read_controller(ConfigTree& config, const sim::Robot& robot, ControllerConfig& c,
                     bool recorded) {
  const auto least = [&](double value) { return recorded ? 0.0 : value; };
  const auto number = [&](const char* key, double& value, double min, double max) {
    value = config.number(std::string("controller.") + key, value, min, max);
  };
  const auto ticks = [&](const char* key, std::uint64_t& value, std::int64_t min,
                         std::uint64_t max = 1'000'000) {
    value = static_cast<std::uint64_t>(config.integer(std::string("controller.") + key,
                                                      static_cast<std::int64_t>(value), min,
                                                      static_cast<std::int64_t>(max)));
  };
  GateConfig& g = c.gate;
  // Before all gains: no drive gets more than its robot's file allows, whoever asks.
  const auto gains = [&](const char* mode, double& kp, double& kd) {
    number(fmt::format("{}.kp_nmprad", mode).c_str(), kp, 0.0, g.kp_limit_nmprad);
    number(fmt::format("{}.kd_nmsprad", mode).c_str(), kd, 0.0, g.kd_limit_nmsprad);
  };
  gains("walk", c.walk.kp_nmprad, c.walk.kd_nmsprad);
  number("walk.stop_deceleration_mps2", c.walk.stop_deceleration_mps2, 0.1, 10.0);
  number("walk.stop_yaw_deceleration_radps2", c.walk.stop_yaw_deceleration_radps2, 0.1, 10.0);
  number("walk.stop_speed_radps", c.walk.stop_speed_radps, 0.0, 1e3);
  number("walk.stop_calm_s", c.walk.stop_calm_s, least(0.1), 60.0);
  number("walk.stop_time_s", c.walk.stop_time_s, least(0.5), 60.0);
  c.walk.latency_ticks = static_cast<std::uint64_t>(
      config.integer("policy.latency_ticks", static_cast<std::int64_t>(c.walk.latency_ticks), 1,
                     kTicksPerPolicyStep - 1));
  gains("stand", c.stand.kp_nmprad, c.stand.kd_nmsprad);
  number("stand.gain_ramp_s", c.stand.gain_ramp_s, 0.0, 2.0);
  number("stand.fold_s", c.stand.fold_s, 0.0, 60.0);
  number("stand.extend_s", c.stand.extend_s, 0.0, 60.0);
  number("stand.blend_s", c.stand.blend_s, least(1.0), 60.0);  // in half of that it topples on sand
  number("stand.max_speed_radps", c.stand.max_speed_radps, 0.1, 20.0);
  number("stand.reached_rad", c.stand.reached_rad, 0.01, 1.0);
  number("stand.reach_s", c.stand.reach_s, 0.0, 10.0);
  // With none a robot that is let down falls.
  number("damping.kd_nmsprad", c.damping.kd_nmsprad, least(kLeastDamping * g.kd_limit_nmsprad),
         g.kd_limit_nmsprad);
  number("damping.fault_s", c.damping.fault_s, least(0.5), 60.0);  // with less it is dropped
  CommandEnvelope& e = c.shaping.envelope;
  number("shaping.forward_mps", e.forward_mps, 0.0, 100.0);
  number("shaping.backward_mps", e.backward_mps, 0.0, 100.0);
  number("shaping.lateral_mps", e.lateral_mps, 0.0, 100.0);
  number("shaping.yaw_radps", e.yaw_radps, 0.0, 100.0);
  number("shaping.acceleration_mps2", e.acceleration_mps2, 0.0, 100.0);
  number("shaping.yaw_acceleration_radps2", e.yaw_acceleration_radps2, 0.0, 100.0);
  number("shaping.centripetal_limit_mps2", c.shaping.centripetal_limit_mps2, 0.0, 100.0);
  ticks("shaping.operator_hold_ticks", c.shaping.operator_hold_ticks, 0);
  number("shaping.operator_stand_s", c.shaping.operator_stand_s, 0.0, 3600.0);
  number("shaping.operator_down_s", c.shaping.operator_down_s, 0.0, 3600.0);
  // 0: those of the robot's joints; else one for all of them, and never above the joint's own.
  const auto lowered = [&](const char* key, JointArray<double>& limits) {
    double limit = 0.0;
    number(key, limit, 0.0, 1e4);
    if (limit == 0.0) return;
    for (double& joint : limits) joint = std::min(joint, limit);
  };
  lowered("gate.speed_limit_radps", g.speed_limit_radps);
  lowered("gate.torque_limit_nm", g.torque_limit_nm);
  for (const auto& t : kGateThresholds) {
    // Those of the robot's file may be lowered, too.
    const double ceiling = recorded                                    ? t.ceiling
                           : t.value == &GateConfig::speed_fault_radps ? robot.speed_fault_radps
                           : t.value == &GateConfig::power_limit_w     ? robot.power_limit_w
                                                                       : t.ceiling;
    if (t.key) number(fmt::format("gate.{}", t.key).c_str(), g.*t.value, t.least, ceiling);
  }
  for (const auto& t : kGateTickThresholds) {
    ticks(fmt::format("gate.{}", t.key).c_str(), g.*t.value, static_cast<std::int64_t>(t.least),
          t.ceiling);
  }
}

/// Throws InputError for a policy whose gains the robot's drives are not to be given.
void require_gains(const PolicySpec& spec, const sim::Robot& robot) {
  const auto check = [&](const char* gain, double value, double limit) {
    if (value <= limit) return;
    throw InputError(fmt::format("policy '{}': {} is {}, the robot '{}' takes at most {}",
                                 spec.name, gain, value, robot.description.name, limit));
  };
  check("kp_nmprad", spec.kp_nmprad, robot.kp_limit_nmprad);
  check("kd_nmsprad", spec.kd_nmsprad, robot.kd_limit_nmsprad);
}

}  // namespace

ControllerConfig controller_config(const sim::Robot& robot) {
  ControllerConfig c;
  c.stand.kp_nmprad = robot.stand_kp_nmprad;
  c.stand.kd_nmsprad = robot.stand_kd_nmsprad;
  c.stand.nominal_rad = robot.nominal_rad;
  c.stand.fold_rad = robot.fold_rad;
  c.damping.kd_nmsprad = robot.damping_kd_nmsprad;
  c.gate.joint_lower_rad = robot.model.lower_rad;
  c.gate.joint_upper_rad = robot.model.upper_rad;
  c.gate.lying_rad = robot.lying_rad;
  c.gate.speed_limit_radps = robot.model.speed_limit_radps;
  c.gate.speed_fault_radps = robot.speed_fault_radps;
  c.gate.kp_limit_nmprad = robot.kp_limit_nmprad;
  c.gate.kd_limit_nmsprad = robot.kd_limit_nmsprad;
  c.gate.power_limit_w = robot.power_limit_w;
  c.gate.continuous_torque_nm = robot.continuous_torque_nm;
  c.gate.thermal_time_s = robot.thermal_time_s;
  c.gate.torque_limit_nm = robot.model.torque_limit_nm;
  return c;
}

ProcessConfig read_process_config(ConfigTree& config, const PolicySpec* spec,
                                  const sim::Robot* robot) {
  ProcessConfig p;
  const std::string name = config.text("robot", "raibo");
  p.robot = robot ? *robot : name == "raibo" ? sim::load_raibo() : sim::load_robot(name);
  p.controller = controller_config(p.robot);
  ControllerConfig& c = p.controller;
  if (spec) {
    require_joints(*spec, p.robot.description);
    require_gains(*spec, p.robot);
    c.walk.kp_nmprad = spec->kp_nmprad;
    c.walk.kd_nmsprad = spec->kd_nmsprad;
    c.shaping.envelope = spec->envelope;
    c.shaping.centripetal_limit_mps2 = spec->yaw_command_clip_mps2;
    for (int j = 0; j < kNumJoints; ++j) {
      double& limit_nm = p.robot.model.torque_limit_nm[j];
      limit_nm = std::min(limit_nm, spec->torque_limit_nm);
      c.gate.torque_limit_nm[j] = limit_nm;
    }
  }
  p.dds = read_dds_config(config);
  p.view_drive = config.flag("view.drive", p.view_drive);
  // Who commands from afar may be lost on the way: the robot then slows down and stands.
  if (p.dds.enabled || p.view_drive) c.shaping.operator_hold_ticks = p.dds.stale_ticks();
  if (config.has("hardware")) {
    p.hardware = read_hardware_config(config, p.robot.description, c.gate);
    fit_gate_to(*p.hardware, c.gate);
  }
  const CommandEnvelope trained = c.shaping.envelope;
  read_controller(config, p.robot, c, robot != nullptr);
  // A stop is not gentler for a robot that is to be driven gently, nor harder than it was trained.
  const CommandEnvelope& set = c.shaping.envelope;
  const auto at_most = [](double& value, double a, double b) {
    value = std::min(value, std::max(a, b));
  };
  at_most(c.walk.stop_deceleration_mps2, trained.acceleration_mps2, set.acceleration_mps2);
  at_most(c.walk.stop_yaw_deceleration_radps2, trained.yaw_acceleration_radps2,
          set.yaw_acceleration_radps2);
  if (p.hardware) fit_drives_to(c.gate, *p.hardware);
  p.driver = read_robot_driver(config, p);
  p.simulator = sim::read_simulator_config(config, p.robot);
  p.realtime = read_realtime_config(config);
  p.recording.bytes = static_cast<std::uint64_t>(
      config.integer("recording.limit_bytes", static_cast<std::int64_t>(p.recording.bytes), 1,
                     std::int64_t{1} << 50));
  p.recording.time_s = config.number("recording.limit_s", p.recording.time_s, 0.1, 1e9);
  p.view_port = static_cast<int>(config.integer("view.port", p.view_port, 0, 65535));
  p.motor_constant =
      config.number("summary.motor_constant", p.robot.motor_constant_nmpsqrtw, 1e-3, 1e3);
  config.reject_unknown();
  p.effective = config.effective();
  return p;
}

}  // namespace sandrunner
