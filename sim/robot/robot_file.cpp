// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/robot_file.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <span>

#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "rt/base/settings.h"
#include "rt/core/gate_config.h"

namespace sandrunner::sim {
namespace {

using F = RobotFile;
constexpr Setting<F> kFile[] = {
    {"name", &F::name, "Name of the robot.", kRequired},
    {"urdf", &F::urdf, "Path of the URDF, relative to this file.", kRequired},
};
constexpr Setting<F> kLegs[] = {
    {"left_front", &F::left_front, "What replaces {leg} in names of links and joints: left front.",
     kRequired},
    {"right_front", &F::right_front, "What replaces {leg}: right front.", kRequired},
    {"left_hind", &F::left_hind, "What replaces {leg}: left hind.", kRequired},
    {"right_hind", &F::right_hind, "What replaces {leg}: right hind.", kRequired},
};
constexpr Setting<F> kJoints[] = {
    {"haa", &F::haa,
     "Name of the hip abduction joint in the URDF, or the four of LF, RF, LH, RH with commas.",
     kRequired},
    {"hfe", &F::hfe, "Name of the hip flexion joint in the URDF, or the four.", kRequired},
    {"kfe", &F::kfe, "Name of the knee joint in the URDF, or the four.", kRequired},
    {"rotor_inertia_kgm2", repeated<1>(&F::rotor_inertia_kgm2), 0.0, 1.0,
     "Inertia of a motor's rotor at the joint: times the gear ratio squared.", kRequired},
    {"friction_nm", repeated<1>(&F::friction_nm), 0.0, 5.0,
     "Dry friction of drive and joint, at the joint."},
    {"lower_rad", repeated<1>(&F::lower_rad), -100.0, 100.0, "Lower stop.",
     "the URDF's; one turn of a continuous joint"},
    {"upper_rad", repeated<1>(&F::upper_rad), -100.0, 100.0, "Upper stop.",
     "the URDF's; one turn of a continuous joint"},
    {"torque_limit_nm", repeated<1>(&F::torque_limit_nm), 1e-3, 1e4, "Largest torque.",
     "the URDF's effort"},
    {"speed_limit_radps", repeated<1>(&F::speed_limit_radps), 1e-3, 1e3, "Largest speed.",
     "the URDF's velocity"},
};
constexpr Setting<F> kLinks[] = {
    {"base", &F::base, "Name of the base's link in the URDF.", kRequired},
    {"hip", &F::hip, "Name of the link that the HAA moves, or the four.", kRequired},
    {"thigh", &F::thigh, "Name of the link that the HFE moves, or the four.", kRequired},
    {"shank", &F::shank, "Name of the link that the KFE moves, or the four.", kRequired},
    {"foot", &F::foot, "Name of the link that is fixed to the shank, or the four.", kRequired},
};

constexpr Setting<F> kShapes[] = {
    {"foot_radius_m", &F::foot_radius_m, 0.0, 0.5,
     "Radius of a ball at the foot link's origin, in place of the URDF's shape.", "from the URDF"},
    {"foot_patches", &F::foot_patches, 1, 4,
     "Points of a foot that touch the ground: 1, of a cylinder 2, of a box 4.",
     "4 of a box, else 1"},
    {"base_box_m", &F::base_box_m, 0.0, 5.0,
     "Edges of the base along x, y, z, in place of the URDF's box.", "from the URDF"},
    {"base_box_centre_m", &F::base_box_centre_m, -5.0, 5.0,
     "Centre of that box, from the base link's origin."},
};

using M = RobotModel<double>;
constexpr Setting<M> kCollision[] = {
    {"knee_radius_m", &M::knee_radius_m, 0.0, 0.5, "Radius of the thigh's lower end.", kRequired},
    {"shank_radius_m", &M::shank_radius_m, 0.0, 0.5, "Half the thickness of the shank.", kRequired},
};

using R = Robot;
constexpr Setting<R> kPose[] = {
    {"nominal_rad", repeated<kJointsPerLeg>(&R::nominal_rad), -7.0, 7.0,
     "HAA, HFE, KFE of every leg, standing; a training wants left and right to be mirror images.",
     kRequired},
    {"lying_rad", repeated<kJointsPerLeg>(&R::lying_rad), -7.0, 7.0,
     "HAA, HFE, KFE on its belly, as a run starts.", kRequired},
    {"fold_rad", &R::fold_rad, -7.0, 7.0,
     "HAA, HFE, KFE folded under the hips: from here the legs extend.", kRequired},
};
constexpr Setting<R> kHeight[] = {
    {"nominal_height_m", &R::nominal_height_m, 0.0, 5.0, "Height of the base, standing.",
     "from the geometry"},
};
// A row whose range is that of the gate's threshold.
constexpr Setting<R> within(const auto& threshold, const char* key, Setting<R>::Member member,
                            const char* meaning) {
  return {key, member, threshold.least, threshold.ceiling, meaning, kRequired};
}
constexpr Setting<R> kGains[] = {
    {"stand_kp_nmprad", &R::stand_kp_nmprad, 0.0, 1e4, "Position gain of standing up and standing.",
     kRequired},
    {"stand_kd_nmsprad", &R::stand_kd_nmsprad, 0.0, 1e3,
     "Velocity gain of standing up and standing.", kRequired},
    within(gate_threshold(&GateConfig::kp_limit_nmprad), "kp_limit_nmprad", &R::kp_limit_nmprad,
           "Largest position gain that a drive is given."),
    within(gate_threshold(&GateConfig::kd_limit_nmsprad), "kd_limit_nmsprad", &R::kd_limit_nmsprad,
           "Largest velocity gain that a drive is given."),
};
// With less than the range a robot that is let down falls.
constexpr Setting<R> damping(double kd_limit_nmsprad) {
  return {"damping_kd_nmsprad",
          repeated<1>(&R::damping_kd_nmsprad),
          kLeastDamping * kd_limit_nmsprad,
          kd_limit_nmsprad,
          "Velocity gain of damping, also after a fault.",
          kRequired,
          "0.1 to 1 times kd_limit_nmsprad"};
}
constexpr Setting<R> kLimits[] = {
    within(gate_threshold(&GateConfig::speed_fault_radps), "speed_fault_radps",
           repeated<1>(&R::speed_fault_radps),
           "A faster joint is a fault; well above normal running."),
    within(gate_threshold(&GateConfig::power_limit_w), "power_w", &R::power_limit_w,
           "Largest mechanical power of all joints together."),
};
constexpr Setting<R> kMotor[] = {
    within(gate_threshold(&GateConfig::continuous_torque_nm), "continuous_torque_nm",
           repeated<1>(&R::continuous_torque_nm),
           "Rms torque that a drive gives for ever, at the joint."),
    within(gate_threshold(&GateConfig::thermal_time_s), "thermal_time_s", &R::thermal_time_s,
           "Time constant with which a motor's windings warm."),
};
constexpr Setting<TorqueSpeedLine> kLine[] = {
    {"stall_torque_nm", repeated<1>(&TorqueSpeedLine::stall_torque_nm), 1e-3, 1e4,
     "Torque of the torque-speed line at rest, at the joint.", kRequired},
    {"no_load_speed_radps", repeated<1>(&TorqueSpeedLine::no_load_speed_radps), 1e-3, 1e4,
     "Speed at which the torque-speed line ends, at the joint.", kRequired},
};
constexpr Setting<R> kConstant[] = {
    {"constant_nmpsqrtw", repeated<1>(&R::motor_constant_nmpsqrtw), 1e-3, 1e3,
     "Motor constant k_m at the joint: its heat is torque^2 / k_m^2.",
     "sqrt(stall torque / no-load speed)"},
    {"torque_speed_line", &R::obeys_torque_speed_line,
     "Simulated drives obey the torque-speed line unless a setting says otherwise."},
};

class Map {
 public:
  Map(const std::string& text, std::string name) : name_(std::move(name)) {
    tree_.add_text(text, name_);
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", name_, what));
  }
  void at_most(const char* key, double value, const char* limit_key, double limit) const {
    if (value > limit) fail(fmt::format("{}: {} is above {}, {}", key, value, limit_key, limit));
  }
  template <typename Settings>
  void read(const char* table, SettingRows<Settings> rows, Settings& settings) {
    for (const Setting<Settings>& row : rows) {
      const std::string key = setting_path(table, row.key);
      if (row.required() && !tree_.has(key)) fail(fmt::format("'{}' is missing", key));
      read_setting(tree_, key, row, settings);
    }
  }
  void reject_unknown() const {
    std::set<std::string> keys;
    for (const SettingLine& line : robot_file_settings()) keys.insert(line.key);
    tree_.reject_unknown(keys);
  }

 private:
  std::string name_;
  ConfigTree tree_;
};

void read_parts(Map& map, RobotFile& file) {
  map.read("", kFile, file);
  map.read("links", kLinks, file);
  map.read("legs", kLegs, file);
  map.read("joints", kJoints, file);
  map.read("collision", kShapes, file);
}

void read_figures(Map& map, const RobotFile& file, Robot& robot) {
  robot.model.rotor_inertia = all_legs(file.rotor_inertia_kgm2);
  robot.model.friction_nm = all_legs(file.friction_nm);
  map.read("collision", kCollision, robot.model);
  map.read("pose", kPose, robot);
  map.read("pose", kHeight, robot);
  map.read("gains", kGains, robot);
  map.read("gains", std::array{damping(robot.kd_limit_nmsprad)}, robot);
  map.at_most("gains.stand_kp_nmprad", robot.stand_kp_nmprad, "gains.kp_limit_nmprad",
              robot.kp_limit_nmprad);
  map.at_most("gains.stand_kd_nmsprad", robot.stand_kd_nmsprad, "gains.kd_limit_nmsprad",
              robot.kd_limit_nmsprad);
  map.read("limits", kLimits, robot);
  map.read("motor", kMotor, robot);
  const TorqueSpeedLine& line = robot.torque_speed_line;
  map.read("motor", kLine, robot.torque_speed_line);
  // Of a DC motor, stall torque = k_t V / R and no-load speed = V / k_t: their ratio is k_t^2 / R,
  // the square of k_m, before and behind the gear.
  for (int j = 0; j < kJointsPerLeg; ++j) {
    robot.motor_constant_nmpsqrtw[j] =
        std::sqrt(line.stall_torque_nm[j] / line.no_load_speed_radps[j]);
  }
  map.read("motor", kConstant, robot);
}

}  // namespace

void RobotFile::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: {}", source, what));
}

RobotFile read_robot_file(const std::string& text, const std::string& source, Robot& robot) {
  Map map(text, source);
  map.reject_unknown();  // a key that is misspelt is not one that is missing
  RobotFile file;
  file.source = source;
  read_parts(map, file);
  read_figures(map, file, robot);
  return file;
}

std::string urdf_in_robot_file(const std::string& text, const std::string& source) {
  RobotFile file;
  Map(text, source).read("", std::span(kFile).last<1>(), file);
  return file.urdf;
}

std::vector<SettingLine> robot_file_settings() {
  std::vector<SettingLine> lines;
  list_settings(lines, "", kFile);
  list_settings(lines, "legs", kLegs);
  list_settings(lines, "joints", kJoints);
  list_settings(lines, "links", kLinks);
  list_settings(lines, "collision", kCollision, kShapes);
  list_settings(lines, "pose", kPose, kHeight);
  list_settings(lines, "gains", kGains, std::array{damping(0.0)});
  list_settings(lines, "limits", kLimits);
  list_settings(lines, "motor", kMotor, kLine, kConstant);
  return lines;
}

}  // namespace sandrunner::sim
