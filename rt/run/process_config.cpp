// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/process_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "drivers/robot_drivers.h"
#include "policy/policy_file.h"
#include "rt/base/errors.h"

namespace sandrunner {
namespace {

struct RobotKey {
  std::string robot = "raibo";
};
constexpr Setting<RobotKey> kRobot[] = {
    {"robot", &RobotKey::robot, "raibo, go2, or the file of another robot (--robot)."},
};
constexpr Setting<ProcessConfig> kView[] = {
    {"drive", &ProcessConfig::view_drive,
     "Pages of --view that have the key may command; --command live sets it."},
    {"port", &ProcessConfig::view_port, 0, 65535, "Port of --view; 0: one that is free."},
};
constexpr Setting<RecordingLimits> kRecording[] = {
    {"limit_bytes", &RecordingLimits::bytes, 1, 0x1p50, "Largest recording."},
    {"limit_s", &RecordingLimits::time_s, 0.1, 1e9, "Longest recording."},
};
constexpr Setting<ProcessConfig> kSummary[] = {
    {"motor_constant", repeated<1>(&ProcessConfig::motor_constant), 1e-3, 1e3,
     "k_m of the cost of transport, N m/sqrt(W) at the joint.", kFromRobotFile},
};

constexpr const char* kFromPolicy = "from the policy file";

/// Ends of ranges that the robot's file gives: no setting gives a drive more than that.
struct RobotRanges {
  double kp_nmprad, kd_nmsprad;
  LegJoints<double> speed_fault_radps;
  double power_w;
  bool recorded = false;  ///< what was run once may be read that no run is to have any more

  double least(double value) const noexcept { return recorded ? 0.0 : value; }
};

constexpr const char* kKpRange = "0 to gains.kp_limit_nmprad of the robot file";
constexpr const char* kKdRange = "0 to gains.kd_limit_nmsprad of the robot file";

using W = WalkConfig;
auto walk_settings(const RobotRanges& r) {
  return std::to_array<Setting<W>>({
      {"kp_nmprad", &W::kp_nmprad, 0.0, r.kp_nmprad, "Position gain of a joint in Walk.",
       kFromPolicy, kKpRange},
      {"kd_nmsprad", &W::kd_nmsprad, 0.0, r.kd_nmsprad, "Velocity gain of a joint in Walk.",
       kFromPolicy, kKdRange},
      {"stop_deceleration_mps2", &W::stop_deceleration_mps2, 0.1, 10.0,
       "Largest deceleration of a stop, of vx and of vy.", "1, at most the policy's"},
      {"stop_yaw_deceleration_radps2", &W::stop_yaw_deceleration_radps2, 0.1, 10.0,
       "Largest deceleration of a stop, of the yaw rate.", "1, at most the policy's"},
      {"stop_speed_radps", &W::stop_speed_radps, 0.0, 1e3,
       "At rest no joint and no body axis turns faster."},
      {"stop_calm_s", &W::stop_calm_s, r.least(0.1), 60.0,
       "A robot has stopped after this long at rest."},
      {"stop_time_s", &W::stop_time_s, r.least(0.5), 60.0,
       "Longest wait for the rest of a stop; then Stand takes over."},
  });
}

constexpr Setting<W> kPolicy[] = {
    {"latency_ticks", &W::latency_ticks, 1, kTicksPerPolicyStep - 1,
     "A policy output acts this long after its input was sampled."},
};

using S = StandConfig;
auto stand_settings(const RobotRanges& r) {
  return std::to_array<Setting<S>>({
      {"kp_nmprad", &S::kp_nmprad, 0.0, r.kp_nmprad, "Position gain of StandUp and Stand.",
       kFromRobotFile, kKpRange},
      {"kd_nmsprad", &S::kd_nmsprad, 0.0, r.kd_nmsprad, "Velocity gain of StandUp and Stand.",
       kFromRobotFile, kKdRange},
      {"gain_ramp_s", &S::gain_ramp_s, 0.0, 2.0,
       "StandUp's stiffness rises from nothing for this long."},
      {"fold_s", &S::fold_s, 0.0, 60.0, "Time to fold the legs."},
      {"extend_s", &S::extend_s, 0.0, 60.0, "Time to extend the legs to the standing posture."},
      // In half of that it topples on sand.
      {"blend_s", &S::blend_s, r.least(1.0), 60.0, "Time from a posture in Walk to Stand."},
      {"max_speed_radps", &S::max_speed_radps, 0.1, 20.0,
       "Largest speed of a joint's target; where it is too low for the times, they grow."},
      {"reached_rad", &S::reached_rad, 0.01, 1.0,
       "Fault: a joint is farther than this from its target when Stand should be reached."},
      {"reach_s", &S::reach_s, 0.0, 10.0,
       "Time that Stand has to be reached, before that is a fault."},
  });
}

using D = DampingConfig;
auto damping_settings(const RobotRanges& r) {
  return std::to_array<Setting<D>>({
      // With none a robot that is let down falls.
      {"kd_nmsprad", repeated<1>(&D::kd_nmsprad), r.least(kLeastDamping * r.kd_nmsprad),
       r.kd_nmsprad, "Velocity gain of Damping and after a fault.", kFromRobotFile,
       "0.1 to 1 times gains.kd_limit_nmsprad of the robot file"},
      // With less it is dropped.
      {"fault_s", &D::fault_s, r.least(0.5), 60.0, "Damping after a fault, before drives go off."},
  });
}

using E = CommandEnvelope;
constexpr Setting<E> kEnvelope[] = {
    {"forward_mps", &E::forward_mps, 0.0, 100.0, "Largest forward command.", kFromPolicy},
    {"backward_mps", &E::backward_mps, 0.0, 100.0, "Largest backward command.", kFromPolicy},
    {"lateral_mps", &E::lateral_mps, 0.0, 100.0, "Largest sideways command.", kFromPolicy},
    {"yaw_radps", &E::yaw_radps, 0.0, 100.0, "Largest commanded yaw rate.", kFromPolicy},
    {"acceleration_mps2", &E::acceleration_mps2, 0.0, 100.0,
     "Largest change of a commanded velocity.", kFromPolicy},
    {"yaw_acceleration_radps2", &E::yaw_acceleration_radps2, 0.0, 100.0,
     "Largest change of the commanded yaw rate.", kFromPolicy},
};

using C = ShapingConfig;
constexpr Setting<C> kShaping[] = {
    {"centripetal_limit_mps2", &C::centripetal_limit_mps2, 0.0, 100.0,
     "Largest commanded speed times yaw rate.", kFromPolicy},
    {"operator_hold_ticks", &C::operator_hold_ticks, 0, 1e6,
     "Without a sign of life of the operator for this long the command is zero; 0: never.",
     "0; with operators dds.stale_s"},
    {"operator_stand_s", &C::operator_stand_s, 0.0, 3600.0,
     "A robot whose operator is lost for this long stops and stands."},
    {"operator_down_s", &C::operator_down_s, 0.0, 3600.0,
     "A robot whose operator is lost for this long is let down."},
};

/// One limit for all joints, in place of the higher ones among their own.
struct LoweredLimits {
  double speed_limit_radps = 0.0, torque_limit_nm = 0.0;
};
constexpr Setting<LoweredLimits> kLowered[] = {
    {"speed_limit_radps", &LoweredLimits::speed_limit_radps, 0.0, 1e4,
     "Lowers each joint's speed limit to this; 0: the robot's own."},
    {"torque_limit_nm", &LoweredLimits::torque_limit_nm, 0.0, 1e4,
     "Lowers each joint's torque limit to this; 0: the robot's own."},
};

/// The thresholds of the gate. Those of the robot's file may be lowered, too.
std::vector<Setting<GateConfig>> gate_settings(const RobotRanges& r) {
  std::vector<Setting<GateConfig>> rows;
  const auto add = [&](const auto& t) {
    if (t.key == nullptr) return;
    rows.emplace_back(t.key, t.value, static_cast<double>(t.least), static_cast<double>(t.ceiling),
                      t.meaning);
  };
  for (const auto& threshold : kGateThresholds) {
    add(threshold);
    const auto from_robot = [&](double GateConfig::* member, double most, const char* range) {
      if (threshold.value != member) return;
      rows.back().max = most;
      rows.back().fallback = kFromRobotFile;
      rows.back().range = range;
    };
    from_robot(&GateConfig::power_limit_w, r.power_w, "0 to limits.power_w of the robot file");
  }
  for (const auto& threshold : kGateTickThresholds) add(threshold);
  for (const auto& t : kGateJointThresholds) {
    if (t.key == nullptr) continue;
    static_assert(std::size(kGateJointThresholds) == 2, "speed_fault_radps alone has a setting");
    rows.emplace_back(t.key, repeated<1>(t.value), t.least,
                      *std::ranges::max_element(r.speed_fault_radps), t.meaning, kFromRobotFile,
                      "0 to limits.speed_fault_radps of the robot file");
  }
  return rows;
}

RobotRanges ranges_of(const sim::Robot& robot, Ranges ranges) {
  const bool recorded = ranges == Ranges::kRecorded;
  // A recording's thresholds are held to what is compiled in alone.
  LegJoints<double> speed_fault_radps = robot.speed_fault_radps;
  if (recorded) speed_fault_radps.fill(gate_threshold(&GateConfig::speed_fault_radps).ceiling);
  const double power_w = gate_threshold(&GateConfig::power_limit_w).ceiling;
  return {.kp_nmprad = robot.kp_limit_nmprad,
          .kd_nmsprad = robot.kd_limit_nmsprad,
          .speed_fault_radps = speed_fault_radps,
          .power_w = recorded ? power_w : robot.power_limit_w,
          .recorded = recorded};
}

/// What the controller has before its own settings are read: from robot, policy, hardware and
/// operators.
ControllerConfig controller_defaults(const sim::Robot& robot, const PolicySpec* spec,
                                     std::uint64_t operator_hold_ticks, const RobotDriver* driver) {
  ControllerConfig c = controller_config(robot);
  if (spec) {
    c.walk.kp_nmprad = spec->kp_nmprad;
    c.walk.kd_nmsprad = spec->kd_nmsprad;
    c.shaping.envelope = spec->envelope;
    c.shaping.centripetal_limit_mps2 = spec->yaw_command_clip_mps2;
  }
  c.shaping.operator_hold_ticks = operator_hold_ticks;
  if (driver) driver->fit_gate(c.gate);
  return c;
}

ControllerConfig read_controller(ConfigTree& config, ControllerConfig c,
                                 const RobotRanges& ranges) {
  const CommandEnvelope trained = c.shaping.envelope;
  read_settings(config, "controller.walk", walk_settings(ranges), c.walk);
  read_settings(config, "policy", kPolicy, c.walk);
  read_settings(config, "controller.stand", stand_settings(ranges), c.stand);
  read_settings(config, "controller.damping", damping_settings(ranges), c.damping);
  read_settings(config, "controller.shaping", kEnvelope, c.shaping.envelope);
  read_settings(config, "controller.shaping", kShaping, c.shaping);
  LoweredLimits lowered;
  read_settings(config, "controller.gate", kLowered, lowered);
  const auto lower = [](double limit, JointArray<double>& limits) {
    if (limit == 0.0) return;
    for (double& joint : limits) joint = std::min(joint, limit);
  };
  lower(lowered.speed_limit_radps, c.gate.speed_limit_radps);
  lower(lowered.torque_limit_nm, c.gate.torque_limit_nm);
  read_settings(config, "controller.gate", gate_settings(ranges), c.gate);
  for (int j = 0; j < kJointsPerLeg; ++j) {  // no joint may be faster than its own
    double& fault_radps = c.gate.speed_fault_radps[j];
    fault_radps = std::min(fault_radps, ranges.speed_fault_radps[j]);
  }
  // A stop is not gentler for a robot that is to be driven gently, nor harder than it was trained.
  const CommandEnvelope& set = c.shaping.envelope;
  const auto at_most = [](double& value, double a, double b) {
    value = std::min(value, std::max(a, b));
  };
  at_most(c.walk.stop_deceleration_mps2, trained.acceleration_mps2, set.acceleration_mps2);
  at_most(c.walk.stop_yaw_deceleration_radps2, trained.yaw_acceleration_radps2,
          set.yaw_acceleration_radps2);
  return c;
}

sim::Robot read_robot(ConfigTree& config, const sim::Robot* recorded) {
  RobotKey key;
  read_settings(config, "", kRobot, key);
  if (recorded) return *recorded;
  return sim::load_robot(key.robot);
}

/// Throws InputError for a policy whose joints are not the robot's, or whose gains its drives are
/// not to be given. Torque limits of the robot become the policy's, where those are lower.
void fit_robot_to(const PolicySpec& spec, sim::Robot& robot) {
  require_joints(spec, robot.description);
  const auto check = [&](const char* gain, double value, double limit) {
    if (value <= limit) return;
    throw InputError(fmt::format("policy '{}': {} is {}, the robot '{}' takes at most {}",
                                 spec.name, gain, value, robot.description.name, limit));
  };
  check("kp_nmprad", spec.kp_nmprad, robot.kp_limit_nmprad);
  check("kd_nmsprad", spec.kd_nmsprad, robot.kd_limit_nmsprad);
  for (double& limit_nm : robot.model.torque_limit_nm) {
    limit_nm = std::min(limit_nm, spec.torque_limit_nm);
  }
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
                                  const sim::Robot* robot, Ranges ranges) {
  ProcessConfig p;
  p.robot = read_robot(config, robot);
  if (spec) fit_robot_to(*spec, p.robot);
  p.dds = read_dds_config(config);
  read_settings(config, "view", kView, p);
  p.driver = make_robot_driver(config, p.robot.description, controller_config(p.robot).gate);
  // Who commands from afar may be lost on the way: the robot then slows down and stands.
  const std::uint64_t hold_ticks = p.dds.enabled || p.view_drive ? p.dds.stale_ticks() : 0;
  p.controller =
      read_controller(config, controller_defaults(p.robot, spec, hold_ticks, p.driver.get()),
                      ranges_of(p.robot, ranges));
  if (p.driver) p.driver->fit_to(p.controller);
  p.simulator = sim::read_simulator_config(config, p.robot);
  p.realtime = read_realtime_config(config);
  read_settings(config, "recording", kRecording, p.recording);
  p.motor_constant = p.robot.motor_constant_nmpsqrtw;
  read_settings(config, "summary", kSummary, p);
  config.reject_unknown();
  p.effective = config.effective();
  return p;
}

std::string shipped_policy_for(ConfigTree& config) {
  const std::string name = read_robot(config, nullptr).description.name;
  return shipped_policy_text(name).empty() ? RobotKey().robot : name;
}

std::vector<SettingLine> process_settings() {
  const RobotRanges in_words{};
  std::vector<SettingLine> lines;
  list_settings(lines, "", kRobot);
  list_settings(lines, "policy", kPolicy);
  list_settings(lines, "controller.walk", walk_settings(in_words));
  list_settings(lines, "controller.stand", stand_settings(in_words));
  list_settings(lines, "controller.damping", damping_settings(in_words));
  list_settings(lines, "controller.shaping", kEnvelope, kShaping);
  list_settings(lines, "controller.gate", kLowered, gate_settings(in_words));
  list_settings(lines, "view", kView);
  list_settings(lines, "recording", kRecording);
  list_settings(lines, "summary", kSummary);
  return lines;
}

}  // namespace sandrunner
