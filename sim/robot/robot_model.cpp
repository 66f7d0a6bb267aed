// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/robot_model.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/core/gate_config.h"
#include "sim/robot/clearance.h"
#include "sim/robot/embedded.h"
#include "sim/robot/ros_description.h"
#include "sim/robot/urdf_reader.h"

namespace sandrunner::sim {
namespace {

using Vec = Vec3<double>;

// What the map calls the parts of the URDF. {leg} in a joint or link stands for a leg's name.
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

// A map in which a key that is asked for must be there: a robot has no figures by default.
class Map {
 public:
  Map(const std::string& text, std::string name) : name_(std::move(name)) {
    tree_.add_text(text, name_);
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", name_, what));
  }
  std::string text(const std::string& key) {
    require(key);
    return tree_.text(key, "");
  }
  double number(const std::string& key, double min, double max) {
    require(key);
    return tree_.number(key, 0.0, min, max);
  }
  double number_or(double fallback, const std::string& key, double min, double max) {
    return tree_.number(key, fallback, min, max);
  }
  /// HAA, HFE, KFE of a leg, rad.
  std::array<double, kJointsPerLeg> pose(const std::string& key) {
    require(key);
    const std::vector<double> q = tree_.numbers(key, {}, kJointsPerLeg, -7.0, 7.0);
    return {q[0], q[1], q[2]};
  }
  void reject_unknown() const { tree_.reject_unknown(); }

 private:
  void require(const std::string& key) const {
    if (!tree_.has(key)) fail(fmt::format("'{}' is missing", key));
  }

  std::string name_;
  ConfigTree tree_;
};

Names read_names(Map& map) {
  return {.base = map.text("links.base"),
          .legs = {map.text("legs.left_front"), map.text("legs.right_front"),
                   map.text("legs.left_hind"), map.text("legs.right_hind")},
          .joints = {map.text("joints.haa"), map.text("joints.hfe"), map.text("joints.kfe")},
          .links = {map.text("links.hip"), map.text("links.thigh"), map.text("links.shank")},
          .foot = map.text("links.foot")};
}

JointArray<double> all_legs(const std::array<double, kJointsPerLeg>& leg) {
  JointArray<double> all;
  for (int j = 0; j < kNumJoints; ++j) all[j] = leg[j % kJointsPerLeg];
  return all;
}

// All figures of the map except the nominal height, which may be left to the geometry.
void read_figures(Map& map, Robot& robot) {
  RobotModel<double>& m = robot.model;
  m.rotor_inertia.fill(map.number("joints.rotor_inertia_kgm2", 0.0, 1.0));
  m.knee_radius_m = map.number("collision.knee_radius_m", 0.0, 0.5);
  m.shank_radius_m = map.number("collision.shank_radius_m", 0.0, 0.5);
  robot.nominal_rad = all_legs(map.pose("pose.nominal_rad"));
  robot.lying_rad = all_legs(map.pose("pose.lying_rad"));
  robot.fold_rad = map.pose("pose.fold_rad");
  robot.stand_kp_nmprad = map.number("gains.stand_kp_nmprad", 0.0, 1e4);
  robot.stand_kd_nmsprad = map.number("gains.stand_kd_nmsprad", 0.0, 1e3);
  const auto limit = [&](const char* key, const GateThreshold<double>& threshold) {
    return map.number(key, threshold.least, threshold.ceiling);
  };
  robot.kp_limit_nmprad =
      limit("gains.kp_limit_nmprad", gate_threshold(&GateConfig::kp_limit_nmprad));
  robot.kd_limit_nmsprad =
      limit("gains.kd_limit_nmsprad", gate_threshold(&GateConfig::kd_limit_nmsprad));
  // With less a robot that is let down falls.
  robot.damping_kd_nmsprad = map.number(
      "gains.damping_kd_nmsprad", kLeastDamping * robot.kd_limit_nmsprad, robot.kd_limit_nmsprad);
  robot.speed_fault_radps =
      limit("limits.speed_fault_radps", gate_threshold(&GateConfig::speed_fault_radps));
  robot.power_limit_w = limit("limits.power_w", gate_threshold(&GateConfig::power_limit_w));
  robot.continuous_torque_nm =
      limit("motor.continuous_torque_nm", gate_threshold(&GateConfig::continuous_torque_nm));
  robot.thermal_time_s = limit("motor.thermal_time_s", gate_threshold(&GateConfig::thermal_time_s));
  TorqueSpeedLine& line = robot.torque_speed_line;
  line.stall_torque_nm = map.number("motor.stall_torque_nm", 1e-3, 1e4);
  line.no_load_speed_radps = map.number("motor.no_load_speed_radps", 1e-3, 1e4);
  // Of a DC motor, stall torque = k_t V / R and no-load speed = V / k_t: their ratio is k_t^2 / R,
  // the square of k_m, before and behind the gear.
  robot.motor_constant_nmpsqrtw =
      map.number_or(std::sqrt(line.stall_torque_nm / line.no_load_speed_radps),
                    "motor.constant_nmpsqrtw", 1e-3, 1e3);
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
  if (joint.type != urdf::Joint::REVOLUTE ||
      std::fabs(dot(to_vec(joint.axis), wanted) - 1.0) > 1e-6) {
    urdf.fail(fmt::format(
        "joint '{}' is not revolute about {}; the joints of a leg are HAA (x), HFE (y), KFE (y)",
        name, j == 0 ? "x" : "y"));
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

// A link that moves by itself and weighs next to nothing is a slip (g for kg), and one that the
// simulator's step cannot resolve. A foot weighs as a part of its shank.
void check_mass(const UrdfReader& urdf, const std::string& link, const Body<double>& body) {
  constexpr double kLeast_kg = 1e-3;
  if (body.mass >= kLeast_kg) return;
  urdf.fail(
      fmt::format("link '{}' has mass {} kg, expected at least {}", link, body.mass, kLeast_kg));
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
  Robot robot;
  robot.description.name = map.text("name");
  robot.description.urdf = urdf_text;
  robot.map = map_text;
  map.text("urdf");
  const Names names = read_names(map);
  robot.description.leg_names = names.legs;
  read_figures(map, robot);
  const double nominal_height_m = map.number_or(0.0, "pose.nominal_height_m", 0.0, 5.0);
  map.reject_unknown();

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
  robot.nominal_height_m =
      nominal_height_m > 0.0
          ? nominal_height_m
          : -lowest_clearance(robot.model, robot.nominal_rad, [](double, double) { return 0.0; });
  return robot;
}

Robot load_robot(const std::string& map_path) {
  const std::string map_text = read_input_file(map_path, "a robot file");
  const std::size_t first = map_text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && map_text[first] == '<') {
    throw InputError(
        fmt::format("{}: found XML, expected a robot file (TOML) that names the URDF; "
                    "sim/robot/README.md tells "
                    "how to write one",
                    map_path));
  }
  const std::string urdf = Map(map_text, map_path).text("urdf");
  const std::string urdf_path =
      (std::filesystem::path(map_path).parent_path() / urdf).lexically_normal().string();
  return parse_robot(map_text, map_path, read_input_file(urdf_path, "a URDF"), urdf_path);
}

Robot load_raibo() {
  return parse_robot(std::string(embedded_robot_file("raibo.toml")), "raibo.toml",
                     std::string(embedded_robot_file("raibo.urdf")), "raibo.urdf");
}

}  // namespace sandrunner::sim
