// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/robot_model.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <span>

#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/base/settings.h"
#include "rt/core/gate_config.h"
#include "sim/robot/clearance.h"
#include "sim/robot/embedded.h"
#include "sim/robot/inertia.h"
#include "sim/robot/ros_description.h"
#include "sim/robot/urdf_reader.h"

namespace sandrunner::sim {
namespace {

using Vec = Vec3<double>;

// What a robot's file says that is no figure of `Robot` as it stands there. {leg} in a joint or
// link stands for a leg's name.
struct RobotFile {
  std::string name, urdf;
  std::string left_front, right_front, left_hind, right_hind;
  std::string haa, hfe, kfe;
  std::string base, hip, thigh, shank, foot;
  LegJoints<double> rotor_inertia_kgm2{}, friction_nm{};
};

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
    {"haa", &F::haa, "Name of the hip abduction joint in the URDF.", kRequired},
    {"hfe", &F::hfe, "Name of the hip flexion joint in the URDF.", kRequired},
    {"kfe", &F::kfe, "Name of the knee joint in the URDF.", kRequired},
    {"rotor_inertia_kgm2", repeated<1>(&F::rotor_inertia_kgm2), 0.0, 1.0,
     "Inertia of a motor's rotor at the joint: times the gear ratio squared.", kRequired},
    {"friction_nm", repeated<1>(&F::friction_nm), 0.0, 5.0,
     "Dry friction of drive and joint, at the joint."},
};
constexpr Setting<F> kLinks[] = {
    {"base", &F::base, "Name of the base's link in the URDF.", kRequired},
    {"hip", &F::hip, "Name of the link that the HAA moves.", kRequired},
    {"thigh", &F::thigh, "Name of the link that the HFE moves.", kRequired},
    {"shank", &F::shank, "Name of the link that the KFE moves.", kRequired},
    {"foot", &F::foot, "Name of the link that is fixed to the shank.", kRequired},
};

using M = RobotModel<double>;
constexpr Setting<M> kCollision[] = {
    {"knee_radius_m", &M::knee_radius_m, 0.0, 0.5, "Radius of the thigh's lower end.", kRequired},
    {"shank_radius_m", &M::shank_radius_m, 0.0, 0.5, "Half the thickness of the shank.", kRequired},
};

using R = Robot;
constexpr Setting<R> kPose[] = {
    {"nominal_rad", repeated<kJointsPerLeg>(&R::nominal_rad), -7.0, 7.0,
     "HAA, HFE, KFE of every leg, standing; a training wants an HAA of 0.", kRequired},
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

// Names of the URDF's parts.
struct Names {
  std::string base;
  std::array<std::string, kNumLegs> legs;
  std::array<std::string, kJointsPerLeg> joints;
  std::array<std::string, kJointsPerLeg> links;  // hip, thigh, shank
  std::string foot;
};

std::string with_leg(std::string pattern, const std::string& leg) {
  const auto at = pattern.find("{leg}");
  if (at != std::string::npos) pattern.replace(at, 5, leg);
  return pattern;
}

// A robot's file, in which every required row must be there: a robot has no figures by
// default.
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

RobotFile read_file(Map& map) {
  RobotFile file;
  map.read("", kFile, file);
  map.read("links", kLinks, file);
  map.read("legs", kLegs, file);
  map.read("joints", kJoints, file);
  return file;
}

Names names_in(const RobotFile& f) {
  return {.base = f.base,
          .legs = {f.left_front, f.right_front, f.left_hind, f.right_hind},
          .joints = {f.haa, f.hfe, f.kfe},
          .links = {f.hip, f.thigh, f.shank},
          .foot = f.foot};
}

JointArray<double> all_legs(const LegJoints<double>& leg) {
  JointArray<double> all;
  for (int j = 0; j < kNumJoints; ++j) all[j] = leg[j % kJointsPerLeg];
  return all;
}

// All figures; the nominal height is 0 where the geometry is to give it.
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

// Joint j of leg l with its limits; returns its origin in the parent's frame, m.
Vec read_joint(const UrdfReader& urdf, const Names& names, int l, int j, const std::string& parent,
               const std::string& child, Robot& robot) {
  const int i = kJointsPerLeg * l + j;
  const std::string name = with_leg(names.joints[j], names.legs[l]);
  robot.description.joint_names[i] = name;
  Vec place_m;
  const urdf::Joint& joint = urdf.joint(name, parent, child, place_m);
  const Vec wanted = j == 0 ? Vec{1, 0, 0} : Vec{0, 1, 0};
  if (joint.type != urdf::Joint::REVOLUTE) {
    urdf.fail(
        fmt::format("joint '{}' is {}, expected revolute, with stops", name,
                    joint.type == urdf::Joint::CONTINUOUS ? "continuous" : "of another type"));
  }
  const Vec axis = to_vec(joint.axis);
  if (std::fabs(dot(axis, wanted) - 1.0) > 1e-6) {
    urdf.fail(fmt::format(
        "joint '{}': found axis {} {} {}, expected {}; a leg has HAA (x), HFE (y), KFE (y)", name,
        axis.x, axis.y, axis.z, j == 0 ? "1 0 0" : "0 1 0"));
  }
  if (!joint.limits || !(joint.limits->lower < joint.limits->upper) ||
      !(joint.limits->effort > 0.0) || !(joint.limits->velocity > 0.0)) {
    urdf.fail(fmt::format("joint '{}' lacks limits lower < upper, effort > 0, velocity > 0", name));
  }
  RobotModel<double>& m = robot.model;
  m.lower_rad[i] = joint.limits->lower;
  m.upper_rad[i] = joint.limits->upper;
  m.torque_limit_nm[i] = joint.limits->effort;
  m.speed_limit_radps[i] = joint.limits->velocity;
  return place_m;
}

// The foot of leg l: its place and its shape. Its mass is the shank's.
void read_foot(const UrdfReader& urdf, const Names& names, int l, const std::string& shank,
               RobotModel<double>& m) {
  LegModel<double>& leg = m.legs[l];
  const std::string name = with_leg(names.foot, names.legs[l]);
  const urdf::Link& foot = urdf.link(name);
  if (!foot.parent_joint || foot.parent_joint->type != urdf::Joint::FIXED) {
    urdf.fail(fmt::format("link '{}' is not fixed to '{}'", name, shank));
  }
  urdf.joint(foot.parent_joint->name, shank, name, leg.foot);
  m.foot_radius_m = m.foot_width_m = 0.0;
  if (const urdf::Cylinder* tyre = urdf.cylinder(name)) {
    m.foot_radius_m = tyre->radius;
    m.foot_width_m = tyre->length;
  } else if (const urdf::Sphere* ball = urdf.sphere(name)) {
    m.foot_radius_m = ball->radius;
  }
  if (!(m.foot_radius_m > 0.0)) {
    urdf.fail(fmt::format("link '{}' has no collision cylinder or sphere", name));
  }
}

// A foot weighs as a part of its shank.
void check_mass(const UrdfReader& urdf, const std::string& link, const Body<double>& body) {
  if (body.mass >= kLeastMass_kg) return;
  urdf.fail(fmt::format("link '{}' has mass {} kg, expected at least {}", link, body.mass,
                        kLeastMass_kg));
}

void read_leg(const UrdfReader& urdf, const Names& names, int l, Robot& robot) {
  const std::string hip = with_leg(names.links[0], names.legs[l]);
  const std::string thigh = with_leg(names.links[1], names.legs[l]);
  const std::string shank = with_leg(names.links[2], names.legs[l]);
  LegModel<double>& leg = robot.model.legs[l];
  leg.haa = read_joint(urdf, names, l, 0, names.base, hip, robot);
  leg.hfe = read_joint(urdf, names, l, 1, hip, thigh, robot);
  leg.kfe = read_joint(urdf, names, l, 2, thigh, shank, robot);
  leg.hip = urdf.body(hip);
  leg.thigh = urdf.body(thigh);
  leg.shank = urdf.body(shank);
  read_foot(urdf, names, l, shank, robot.model);
  check_mass(urdf, hip, leg.hip);
  check_mass(urdf, thigh, leg.thigh);
  check_mass(urdf, shank, leg.shank);
}

void read_base(const UrdfReader& urdf, const std::string& base, RobotModel<double>& m) {
  m.base = urdf.body(base);
  check_mass(urdf, base, m.base);
  const urdf::Box* box = urdf.box(base, m.base_box_centre_m);
  if (!box) urdf.fail(fmt::format("link '{}' has no collision box", base));
  m.base_box_half_m = {box->dim.x / 2, box->dim.y / 2, box->dim.z / 2};
}

// A pose that the robot is sent to, or starts in, must lie between its stops.
void check_pose(const Map& map, const char* key, const JointArray<double>& q, const Robot& robot) {
  const RobotModel<double>& m = robot.model;
  for (int j = 0; j < kNumJoints; ++j) {
    if (q[j] >= m.lower_rad[j] && q[j] <= m.upper_rad[j]) continue;
    map.fail(fmt::format("{}: {} rad is past a stop of joint '{}', which turns from {} to {}", key,
                         q[j], robot.description.joint_names[j], m.lower_rad[j], m.upper_rad[j]));
  }
}

}  // namespace

Robot parse_robot(const std::string& map_text, const std::string& map_name,
                  const std::string& urdf_text, const std::string& urdf_name) {
  Map map(map_text, map_name);
  const UrdfReader urdf(urdf_text, urdf_name);
  map.reject_unknown();  // a key that is misspelt is not one that is missing
  const RobotFile file = read_file(map);
  const Names names = names_in(file);
  Robot robot;
  robot.description.name = file.name;
  robot.description.urdf = urdf_text;
  robot.description.leg_names = names.legs;
  robot.map = map_text;
  read_figures(map, file, robot);

  read_base(urdf, names.base, robot.model);
  if (urdf.moving_joints() != kNumJoints) {
    urdf.fail(fmt::format("has {} moving joints, expected {}: four legs of HAA, HFE, KFE",
                          urdf.moving_joints(), kNumJoints));
  }
  for (int l = 0; l < kNumLegs; ++l) read_leg(urdf, names, l, robot);
  urdf.reject_other_masses();
  std::array<LegLinks, kNumLegs> leg_links;
  for (int l = 0; l < kNumLegs; ++l) {
    leg_links[l] = {with_leg(names.links[2], names.legs[l]), with_leg(names.foot, names.legs[l])};
  }
  describe_for_ros(urdf, names.base, leg_links, robot);
  check_pose(map, "pose.nominal_rad", robot.nominal_rad, robot);
  check_pose(map, "pose.lying_rad", robot.lying_rad, robot);
  check_pose(map, "pose.fold_rad", all_legs(robot.fold_rad), robot);
  if (robot.nominal_height_m == 0.0) {
    robot.nominal_height_m =
        -lowest_clearance(robot.model, robot.nominal_rad, [](double, double) { return 0.0; });
  }
  return robot;
}

Robot load_robot(const std::string& map_path) {
  if (const std::string_view map = embedded_robot_file(map_path + ".toml"); !map.empty()) {
    return parse_robot(std::string(map), map_path + ".toml",
                       std::string(embedded_robot_file(map_path + ".urdf")), map_path + ".urdf");
  }
  const std::string map_text = read_input_file(map_path, "raibo, go2 or a robot file");
  const std::size_t first = map_text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && map_text[first] == '<') {
    throw InputError(
        fmt::format("{}: found XML, expected a robot file (TOML) that names the URDF; "
                    "sim/robot/README.md tells how to write one",
                    map_path));
  }
  RobotFile file;
  Map(map_text, map_path).read("", std::span(kFile).last<1>(), file);
  const std::string urdf_path =
      (std::filesystem::path(map_path).parent_path() / file.urdf).lexically_normal().string();
  return parse_robot(map_text, map_path, read_input_file(urdf_path, "a URDF"), urdf_path);
}

std::vector<SettingLine> robot_file_settings() {
  std::vector<SettingLine> lines;
  list_settings(lines, "", kFile);
  list_settings(lines, "legs", kLegs);
  list_settings(lines, "joints", kJoints);
  list_settings(lines, "links", kLinks);
  list_settings(lines, "collision", kCollision);
  list_settings(lines, "pose", kPose);
  list_settings(lines, "pose", kHeight);
  list_settings(lines, "gains", kGains);
  list_settings(lines, "gains", std::array{damping(0.0)});
  list_settings(lines, "limits", kLimits);
  list_settings(lines, "motor", kMotor);
  list_settings(lines, "motor", kLine);
  list_settings(lines, "motor", kConstant);
  return lines;
}

Robot load_raibo() { return load_robot("raibo"); }

}  // namespace sandrunner::sim
