// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/process_config.h"

#include <fmt/format.h>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

void read_controller(ConfigTree& config, ControllerConfig& c) {
  const auto number = [&](const char* key, double& value, double min, double max) {
    value = config.number(std::string("controller.") + key, value, min, max);
  };
  const auto ticks = [&](const char* key, std::uint64_t& value, std::int64_t min) {
    value = static_cast<std::uint64_t>(config.integer(
        std::string("controller.") + key, static_cast<std::int64_t>(value), min, 1'000'000));
  };
  number("walk.kp_nmprad", c.walk.kp_nmprad, 0.0, 1e4);
  number("walk.kd_nmsprad", c.walk.kd_nmsprad, 0.0, 1e3);
  number("walk.stop_deceleration_mps2", c.walk.stop_deceleration_mps2, 0.0, 1e3);
  number("walk.stop_yaw_deceleration_radps2", c.walk.stop_yaw_deceleration_radps2, 0.0, 1e3);
  number("walk.stop_speed_radps", c.walk.stop_speed_radps, 0.0, 1e3);
  number("walk.stop_calm_s", c.walk.stop_calm_s, 0.0, 60.0);
  number("walk.stop_time_s", c.walk.stop_time_s, 0.0, 60.0);
  c.walk.latency_ticks = static_cast<std::uint64_t>(
      config.integer("policy.latency_ticks", static_cast<std::int64_t>(c.walk.latency_ticks), 1,
                     kTicksPerPolicyStep - 1));
  number("stand.kp_nmprad", c.stand.kp_nmprad, 0.0, 1e4);
  number("stand.kd_nmsprad", c.stand.kd_nmsprad, 0.0, 1e3);
  number("stand.fold_s", c.stand.fold_s, 0.0, 60.0);
  number("stand.extend_s", c.stand.extend_s, 0.0, 60.0);
  number("stand.blend_s", c.stand.blend_s, 0.0, 60.0);
  number("stand.max_speed_radps", c.stand.max_speed_radps, 0.1, 100.0);
  number("damping.kd_nmsprad", c.damping.kd_nmsprad, 0.0, 1e3);
  number("damping.fault_s", c.damping.fault_s, 0.0, 60.0);
  number("shaping.centripetal_limit_mps2", c.shaping.centripetal_limit_mps2, 0.0, 100.0);
  number("shaping.acceleration_limit_mps2", c.shaping.acceleration_limit_mps2, 0.0, 1e3);
  number("shaping.yaw_acceleration_limit_radps2", c.shaping.yaw_acceleration_limit_radps2, 0.0,
         1e3);
  ticks("shaping.operator_hold_ticks", c.shaping.operator_hold_ticks, 0);
  GateConfig& g = c.gate;
  number("gate.joint_fault_rad", g.joint_fault_rad, 0.0, 10.0);
  number("gate.target_margin_rad", g.target_margin_rad, 0.0, 10.0);
  // 0: those of the robot's joints; else one for all of them.
  double speed_limit_radps = 0.0, torque_limit_nm = 0.0;
  number("gate.speed_limit_radps", speed_limit_radps, 0.0, 1e4);
  if (speed_limit_radps > 0.0) g.speed_limit_radps = all_joints(speed_limit_radps);
  number("gate.speed_fault_radps", g.speed_fault_radps, 0.0, 1e4);
  number("gate.torque_limit_nm", torque_limit_nm, 0.0, 1e4);
  if (torque_limit_nm > 0.0) g.torque_limit_nm = all_joints(torque_limit_nm);
  number("gate.torque_fault_ratio", g.torque_fault_ratio, 0.0, 100.0);
  number("gate.torque_fault_s", g.torque_fault_s, 0.0, 10.0);
  number("gate.tilt_limit_deg", g.tilt_limit_deg, 0.0, 180.0);
  number("gate.tilt_fault_deg", g.tilt_fault_deg, 0.0, 180.0);
  ticks("gate.joints_limit_ticks", g.joints_limit_ticks, 0);
  ticks("gate.joints_fault_ticks", g.joints_fault_ticks, 0);
  ticks("gate.imu_limit_ticks", g.imu_limit_ticks, 0);
  ticks("gate.imu_fault_ticks", g.imu_fault_ticks, 0);
  ticks("gate.policy_fault_ticks", g.policy_fault_ticks, kTicksPerPolicyStep);
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
  c.gate.speed_limit_radps = robot.model.speed_limit_radps;
  c.gate.speed_fault_radps = robot.speed_fault_radps;
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
    c.walk.kp_nmprad = spec->kp_nmprad;
    c.walk.kd_nmsprad = spec->kd_nmsprad;
    c.shaping.centripetal_limit_mps2 = spec->yaw_command_clip_mps2;
    if (spec->torque_limit_nm > 0.0) {
      for (double& limit : p.robot.model.torque_limit_nm)
        limit = std::min(limit, spec->torque_limit_nm);
    }
  }
  p.dds = read_dds_config(config);
  // Who commands from afar may be lost on the way: the robot then slows down and stands.
  if (p.dds.enabled) c.shaping.operator_hold_ticks = p.dds.stale_ticks();
  read_controller(config, c);
  p.simulator = sim::read_simulator_config(config, p.robot);
  p.realtime = read_realtime_config(config);
  p.recording.bytes = static_cast<std::uint64_t>(
      config.integer("recording.limit_bytes", static_cast<std::int64_t>(p.recording.bytes), 1,
                     std::int64_t{1} << 50));
  p.recording.time_s = config.number("recording.limit_s", p.recording.time_s, 0.1, 1e9);
  p.motor_constant =
      config.number("summary.motor_constant", p.robot.motor_constant_nmpsqrtw, 1e-3, 1e3);
  config.reject_unknown();
  p.effective = config.effective();
  return p;
}

}  // namespace sandrunner
