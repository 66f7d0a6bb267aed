// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/robot_model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <sstream>
#include <vector>

#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/base/likely_meant.h"
#include "sim/robot/clearance.h"
#include "sim/robot/embedded.h"
#include "sim/robot/inertia.h"
#include "sim/robot/robot_file.h"
#include "sim/robot/ros_description.h"
#include "sim/robot/urdf_legs.h"
#include "sim/robot/urdf_reader.h"

namespace sandrunner::sim {
namespace {

using Vec = Vec3<double>;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

// The part of leg l: of a pattern with {leg}, or of four names with commas between.
std::string part_of(std::string pattern, const RobotFile& file, int l) {
  if (pattern.find(',') != std::string::npos) {
    std::istringstream list(pattern);
    std::vector<std::string> four;
    for (std::string name; std::getline(list, name, ',');) {
      const std::size_t begin = std::min(name.find_first_not_of(' '), name.size());
      four.push_back(name.substr(begin, name.find_last_not_of(' ') + 1 - begin));
    }
    if (four.size() != kNumLegs) {
      file.fail(
          fmt::format("found {} names in '{}', expected one with {{leg}}, or those of "
                      "LF, RF, LH and RH",
                      four.size(), pattern));
    }
    return four[static_cast<std::size_t>(l)];
  }
  constexpr std::string_view kLeg = "{leg}";
  const std::string leg = file.legs()[l];
  for (auto at = pattern.find(kLeg); at != std::string::npos;
       at = pattern.find(kLeg, at + leg.size())) {
    pattern.replace(at, kLeg.size(), leg);
  }
  return pattern;
}

// Stops, torque and speed limit of joint j of leg l.
void read_limits(const UrdfReader& urdf, const RobotFile& file, const urdf::Joint& joint, int l,
                 int j, RobotModel<double>& m) {
  const int i = kJointsPerLeg * l + j;
  const bool turns_for_ever = joint.type == urdf::Joint::CONTINUOUS;
  if (!turns_for_ever && joint.type != urdf::Joint::REVOLUTE) {
    urdf.fail(fmt::format("joint '{}' is neither revolute nor continuous", joint.name));
  }
  const urdf::JointLimits limits = joint.limits ? *joint.limits : urdf::JointLimits();
  const auto chosen = [](double own, double in_urdf) { return std::isfinite(own) ? own : in_urdf; };
  m.lower_rad[i] = chosen(file.lower_rad[j], turns_for_ever ? -kTurn_rad : limits.lower);
  m.upper_rad[i] = chosen(file.upper_rad[j], turns_for_ever ? kTurn_rad : limits.upper);
  m.torque_limit_nm[i] = chosen(file.torque_limit_nm[j], limits.effort);
  m.speed_limit_radps[i] = chosen(file.speed_limit_radps[j], limits.velocity);
  if (!(m.torque_limit_nm[i] > 0.0) || !(m.speed_limit_radps[i] > 0.0)) {
    urdf.fail(
        fmt::format("joint '{}' lacks limits effort > 0, velocity > 0; the robot file may give "
                    "joints.torque_limit_nm, joints.speed_limit_radps",
                    joint.name));
  }
  urdf.check_stops(joint.name, m.lower_rad[i], m.upper_rad[i]);
}

// Joint j of leg l; returns where it is from the parent's origin, base axes, m.
Vec read_joint(const UrdfReader& urdf, const RobotFile& file, const std::string& pattern, int l,
               int j, const std::string& parent, const std::string& child, Robot& robot) {
  const std::string name = part_of(pattern, file, l);
  robot.description.joint_names[kJointsPerLeg * l + j] = name;
  Vec place_m, axis;
  const urdf::Joint& joint = urdf.joint(name, parent, child, place_m, axis);
  read_limits(urdf, file, joint, l, j, robot.model);
  const double along = j == 0 ? axis.x : axis.y;
  if (std::fabs(std::fabs(along) - 1.0) > 1e-6) {
    urdf.fail(fmt::format(
        "joint '{}': found axis {:.3g} {:.3g} {:.3g} in the axes of '{}', expected {}, either way; "
        "a leg has HAA (x), HFE (y), KFE (y), the front is x, the left is y",
        name, axis.x, axis.y, axis.z, file.base, j == 0 ? "1 0 0" : "0 1 0"));
  }
  robot.model.legs[l].sign[j] = std::copysign(1.0, along);
  return place_m;
}

// A foot's patches lie so that, where the force on each grows with its depth, force and moment of a
// foot at an angle are those of its whole width and length (the points of Gauss's quadrature).
void lay_patches(const RobotFile& file, const std::string& link, const UrdfFoot& foot,
                 LegModel<double>& leg, RobotModel<double>& m) {
  const int most = foot.length_m > 0.0 ? 4 : foot.width_m > 0.0 ? 2 : 1;
  const int patches = file.foot_patches > 0 ? file.foot_patches : most == 4 ? 4 : 1;
  if (patches != 1 && patches != most) {
    file.fail(fmt::format("collision.foot_patches: found {}, expected {} of the {} of link '{}'",
                          patches, most == 1 ? "1" : fmt::format("1 or {}", most),
                          most == 4   ? "box"
                          : most == 2 ? "cylinder"
                                      : "ball",
                          link));
  }
  const double share = 0.5 * std::numbers::inv_sqrt3;
  for (int i = 0; i < patches && patches > 1; ++i) {
    const double ahead_m = patches == 4 ? (i < 2 ? share : -share) * foot.length_m : 0.0;
    const double left_m = (i % 2 == 0 ? share : -share) * foot.width_m;
    leg.patch[static_cast<std::size_t>(i)] = ahead_m * foot.along + left_m * foot.across;
  }
  m.foot_patches = patches;
}

// The foot of leg l: its place and its shape, whose centre it returns in the foot link's own axes.
// Its mass is the shank's.
Vector3 read_foot(const UrdfReader& urdf, const RobotFile& file, const std::string& name,
                  const std::string& shank, int l, RobotModel<double>& m) {
  LegModel<double>& leg = m.legs[l];
  const urdf::Link& link = urdf.link(name);
  if (!link.parent_joint || link.parent_joint->type != urdf::Joint::FIXED) {
    urdf.fail(fmt::format("link '{}' is not fixed to '{}'", name, shank));
  }
  Vec axis;
  urdf.joint(link.parent_joint->name, shank, name, leg.foot, axis);
  UrdfFoot foot{.radius_m = file.foot_radius_m};
  if (foot.radius_m == 0.0) foot = urdf.foot(name, leg.foot);
  leg.foot = leg.foot + foot.centre_m;
  if (l > 0 && (std::fabs(foot.radius_m - m.foot_radius_m) > 1e-3 ||
                std::fabs(foot.width_m - m.foot_width_m) > 1e-3 ||
                std::fabs(foot.length_m - m.foot_length_m) > 1e-3)) {
    urdf.fail(fmt::format(
        "link '{}': found a foot of radius {} m, width {} m and length {} m, expected {}, {} and "
        "{} as of the left front leg",
        name, foot.radius_m, foot.width_m, foot.length_m, m.foot_radius_m, m.foot_width_m,
        m.foot_length_m));
  }
  m.foot_radius_m = foot.radius_m;
  m.foot_width_m = foot.width_m;
  m.foot_length_m = foot.length_m;
  lay_patches(file, name, foot, leg, m);
  return {foot.in_link_m.x, foot.in_link_m.y, foot.in_link_m.z};
}

// A foot weighs as a part of its shank.
void check_mass(const UrdfReader& urdf, const std::string& link, const Body<double>& body) {
  if (body.mass >= kLeastMass_kg) return;
  urdf.fail(fmt::format("link '{}' has mass {} kg, expected at least {}", link, body.mass,
                        kLeastMass_kg));
}

LegLinks read_leg(const UrdfReader& urdf, const RobotFile& file, int l, Robot& robot) {
  LegLinks links{.hip = part_of(file.hip, file, l),
                 .thigh = part_of(file.thigh, file, l),
                 .shank = part_of(file.shank, file, l),
                 .foot = part_of(file.foot, file, l)};
  LegModel<double>& leg = robot.model.legs[l];
  leg.haa = read_joint(urdf, file, file.haa, l, 0, file.base, links.hip, robot);
  leg.hfe = read_joint(urdf, file, file.hfe, l, 1, links.hip, links.thigh, robot);
  leg.kfe = read_joint(urdf, file, file.kfe, l, 2, links.thigh, links.shank, robot);
  leg.hip = urdf.body(links.hip);
  leg.thigh = urdf.body(links.thigh);
  leg.shank = urdf.body(links.shank);
  links.foot_centre_m = read_foot(urdf, file, links.foot, links.shank, l, robot.model);
  check_mass(urdf, links.hip, leg.hip);
  check_mass(urdf, links.thigh, leg.thigh);
  check_mass(urdf, links.shank, leg.shank);
  return links;
}

void read_base(const UrdfReader& urdf, const RobotFile& file, RobotModel<double>& m) {
  m.base = urdf.body(file.base);
  check_mass(urdf, file.base, m.base);
  const std::array<double, 3>&edges = file.base_box_m, &centre = file.base_box_centre_m;
  std::optional<UrdfBox> box = urdf.box();
  if (file.has_base_box()) {
    if (!(edges[0] * edges[1] * edges[2] > 0.0)) {
      file.fail(fmt::format("collision.base_box_m: found {} {} {}, expected three above 0",
                            edges[0], edges[1], edges[2]));
    }
    box = UrdfBox{{centre[0], centre[1], centre[2]}, {edges[0] / 2, edges[1] / 2, edges[2] / 2}};
  }
  if (!box) {
    urdf.fail(fmt::format(
        "link '{}' has no collision box, expected one, or collision.base_box_m in the robot file",
        file.base));
  }
  m.base_box_centre_m = box->centre_m;
  m.base_box_half_m = box->half_m;
}

void check_joints(const UrdfReader& urdf, const RobotFile& file) {
  std::vector<std::string> others = urdf.moving_joints();
  const std::size_t found = others.size();
  for (int l = 0; l < kNumLegs; ++l) {
    for (const auto& joint : {file.haa, file.hfe, file.kfe})
      std::erase(others, part_of(joint, file, l));
  }
  if (found == kNumJoints || others.empty()) return;
  if (others.size() > 4) {
    others.resize(4);
    others.emplace_back("...");
  }
  urdf.fail(
      fmt::format("has {} moving joints, expected {}, four legs of HAA, HFE, KFE; of no leg: {}",
                  found, kNumJoints, fmt::join(others, ", ")));
}

// The legs are where their names say.
void check_sides(const RobotFile& file, const RobotModel<double>& m) {
  const std::array<std::string, kNumLegs> legs = file.legs();
  std::array<Vec, kNumLegs> hips;
  for (int l = 0; l < kNumLegs; ++l) hips[l] = m.legs[l].haa + m.legs[l].hfe;
  for (int l = 0; l < kNumLegs; ++l) {
    const Vec from_other_side = hips[l] - hips[l ^ 1], from_other_end = hips[l] - hips[l ^ 2];
    if ((l % 2 == 0) != (from_other_side.y > 0.0)) {
      file.fail(fmt::format(
          "legs.{}: the URDF has '{}' at y = {:.3g} m and '{}' at {:.3g}, expected the left one at "
          "the greater y",
          kLegKeys[l], legs[l], hips[l].y, legs[l ^ 1], hips[l ^ 1].y));
    }
    if ((l < 2) != (from_other_end.x > 0.0)) {
      file.fail(
          fmt::format("legs.{}: the URDF has '{}' at x = {:.3g} m and '{}' at {:.3g}, expected the "
                      "front one at "
                      "the greater x",
                      kLegKeys[l], legs[l], hips[l].x, legs[l ^ 2], hips[l ^ 2].x));
    }
  }
}

// A pose that the robot is sent to, or starts in, must lie between its stops.
void check_pose(const RobotFile& file, const char* key, const JointArray<double>& q,
                const Robot& robot) {
  const RobotModel<double>& m = robot.model;
  for (int j = 0; j < kNumJoints; ++j) {
    if (q[j] >= m.lower_rad[j] && q[j] <= m.upper_rad[j]) continue;
    file.fail(fmt::format("{}: {} rad is past a stop of joint '{}', which turns from {} to {}", key,
                          q[j], robot.description.joint_names[j], m.lower_rad[j], m.upper_rad[j]));
  }
}

}  // namespace

Robot parse_robot(const std::string& map_text, const std::string& map_name,
                  const std::string& urdf_text, const std::string& urdf_name) {
  Robot robot;
  const RobotFile file = read_robot_file(map_text, map_name, robot);
  const UrdfReader urdf(urdf_text, urdf_name, file.base);
  robot.description.name = file.name;
  robot.description.urdf = urdf_text;
  robot.description.leg_names = file.legs();
  robot.map = map_text;

  check_joints(urdf, file);
  read_base(urdf, file, robot.model);
  std::array<LegLinks, kNumLegs> links;
  for (int l = 0; l < kNumLegs; ++l) links[l] = read_leg(urdf, file, l, robot);
  check_sides(file, robot.model);
  urdf.reject_other_masses();
  describe_for_ros(urdf, file.base, links, robot);
  check_pose(file, "pose.nominal_rad", robot.nominal_rad, robot);
  check_pose(file, "pose.lying_rad", robot.lying_rad, robot);
  check_pose(file, "pose.fold_rad", all_legs(robot.fold_rad), robot);
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
  const bool is_name = map_path.find_first_of("./") == std::string::npos;
  const std::string meant = is_name ? likely_meant(map_path, {"raibo", "go2"}) : "";
  const std::string map_text =
      read_input_file(map_path, meant.empty() ? "raibo, go2 or a robot file"
                                              : fmt::format("a robot file, or '{}'", meant));
  const std::size_t first = map_text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && map_text[first] == '<') {
    throw InputError(
        fmt::format("{}: found XML, expected a robot file (TOML) that names the URDF; "
                    "sim/robot/README.md tells how to write one",
                    map_path));
  }
  const std::string urdf = urdf_in_robot_file(map_text, map_path);
  const std::string urdf_path =
      (std::filesystem::path(map_path).parent_path() / urdf).lexically_normal().string();
  return parse_robot(map_text, map_path, read_input_file(urdf_path, "a URDF"), urdf_path);
}

Robot load_raibo() { return load_robot("raibo"); }

}  // namespace sandrunner::sim
