// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/describe.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "sim/robot/robot_file.h"
#include "sim/robot/urdf_reader.h"

namespace sandrunner::sim {
namespace {

using Vec = Vec3<double>;

std::string text(const Vec& v) { return fmt::format("{:.4g} {:.4g} {:.4g}", v.x, v.y, v.z); }

/// Links with a mass that hang from `link` by fixed joints.
void add_fixed(const UrdfReader& urdf, const urdf::Link& link, std::vector<std::string>& names) {
  for (const auto& joint : link.child_joints) {
    if (joint->type != urdf::Joint::FIXED) continue;
    const urdf::Link& child = urdf.link(joint->child_link_name);
    if (child.inertial && child.inertial->mass > 0.0) names.push_back(child.name);
    add_fixed(urdf, child, names);
  }
}

std::string body_row(const UrdfReader& urdf, const std::string& name, const Body<double>& body) {
  std::vector<std::string> fixed;
  add_fixed(urdf, urdf.link(name), fixed);
  return fmt::format("| {} | {:.4g} | {} | {} |\n", name, body.mass, text(body.com),
                     fmt::join(fixed, ", "));
}

std::string joint_row(const UrdfReader& urdf, const Robot& robot, int i) {
  const RobotModel<double>& m = robot.model;
  const int j = i % kJointsPerLeg;
  const std::string& name = robot.description.joint_names[i];
  const auto found = urdf.model().joints_.find(name);
  const bool turns_for_ever =
      found != urdf.model().joints_.end() && found->second->type == urdf::Joint::CONTINUOUS;
  return fmt::format("| {} | {}{} | {:.4g} to {:.4g}{} | {:.4g} | {:.4g} | {:.4g} |\n", name,
                     m.legs[i / kJointsPerLeg].sign[j] < 0.0 ? "-" : "", j == 0 ? "x" : "y",
                     m.lower_rad[i], m.upper_rad[i], turns_for_ever ? " (continuous)" : "",
                     m.torque_limit_nm[i], m.speed_limit_radps[i], m.rotor_inertia[i]);
}

/// The collision shapes of the URDF that are no foot and not the base's box.
std::size_t unused_shapes(const UrdfReader& urdf, const RobotFile& file) {
  std::size_t shapes = 0;
  for (const auto& [name, link] : urdf.model().links_) shapes += link->collision_array.size();
  if (!file.has_base_box()) shapes -= 1;
  if (file.foot_radius_m == 0.0) shapes -= kNumLegs;
  return shapes;
}

std::string feet_of(const RobotModel<double>& m) {
  const std::string points =
      m.foot_patches > 1.0 ? fmt::format(", each on {} points", static_cast<int>(m.foot_patches))
                           : "";
  if (m.foot_length_m > 0.0) {
    return fmt::format("soles {:.4g} m long, {:.4g} m wide and {:.4g} m thick{}", m.foot_length_m,
                       m.foot_width_m, 2.0 * m.foot_radius_m, points);
  }
  if (m.foot_width_m > 0.0) {
    return fmt::format("tyres of radius {:.4g} m, {:.4g} m wide{}", m.foot_radius_m, m.foot_width_m,
                       points);
  }
  return fmt::format("balls of radius {:.4g} m", m.foot_radius_m);
}

}  // namespace

std::string describe(const Robot& robot) {
  Robot figures;  // of the robot's file alone
  const RobotFile file = read_robot_file(robot.map, robot.description.name, figures);
  const UrdfReader urdf(robot.description.urdf, robot.description.name, file.base);
  const RobotModel<double>& m = robot.model;
  std::string page = fmt::format(
      "# {}\n{:.4g} kg, base {:.4g} m high when it stands. Vectors are in the axes of '{}' with "
      "all "
      "joints at zero: front x, left y, up z.\n\n"
      "| body | mass, kg | centre of mass from its origin, m | with |\n|---|---|---|---|\n",
      robot.description.name, m.mass(), robot.nominal_height_m, file.base);
  page += body_row(urdf, file.base, m.base);
  for (const LegModel<double>& leg : m.legs) {
    const auto& names = robot.description.joint_names;
    const std::size_t first = kJointsPerLeg * static_cast<std::size_t>(&leg - m.legs.data());
    const Body<double>* const bodies[] = {&leg.hip, &leg.thigh, &leg.shank};
    for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
      page += body_row(urdf, urdf.model().getJoint(names[first + j])->child_link_name, *bodies[j]);
    }
  }
  page +=
      "\n| joint | axis | stops, rad | torque, N m | speed, rad/s | rotor, kg m^2 |\n"
      "|---|---|---|---|---|---|\n";
  for (int i = 0; i < kNumJoints; ++i) page += joint_row(urdf, robot, i);
  page +=
      "\n| leg | HAA from the base | HFE from it | KFE from it | foot from it |\n"
      "|---|---|---|---|---|\n";
  for (int l = 0; l < kNumLegs; ++l) {
    const LegModel<double>& leg = m.legs[l];
    page += fmt::format("| {} | {} | {} | {} | {} |\n", robot.description.leg_names[l],
                        text(leg.haa), text(leg.hfe), text(leg.kfe), text(leg.foot));
  }
  page += fmt::format("\nFeet: {}. Base: a box of {} m around {}.\n", feet_of(m),
                      text(2.0 * m.base_box_half_m), text(m.base_box_centre_m));
  page += fmt::format(
      "Not used: {} other collision shapes of the URDF. Knees and shanks touch the ground with "
      "radii of {:.4g} and {:.4g} m.\n",
      unused_shapes(urdf, file), m.knee_radius_m, m.shank_radius_m);
  return page;
}

}  // namespace sandrunner::sim
