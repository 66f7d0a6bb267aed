// SPDX-License-Identifier: BSD-3-Clause
// A second robot, of the tests' own making: half of Raibo's mass, three quarters of its lengths,
// other names, poses, gains and limits, ball feet. What works with it has no figure of Raibo's.
#pragma once

#include <fmt/format.h>

#include <string>

#include "tests/support/temporary_folder.h"

namespace sandrunner {

inline constexpr const char* kSmallRobotMap = R"(
name = "small"
urdf = "small.urdf"
[legs]
left_front = "fl"
right_front = "fr"
left_hind = "rl"
right_hind = "rr"
[joints]
haa = "{leg}_roll"
hfe = "{leg}_pitch"
kfe = "{leg}_knee"
rotor_inertia_kgm2 = 0.002
[links]
base = "trunk"
hip = "{leg}_hip"
thigh = "{leg}_upper"
shank = "{leg}_lower"
foot = "{leg}_ball"
[collision]
knee_radius_m = 0.02
shank_radius_m = 0.01
[pose]
nominal_rad = [0.0, 0.65, -1.3]
lying_rad = [0.0, 2.4, -2.3]
fold_rad = [0.0, 1.1, -2.2]
[gains]
stand_kp_nmprad = 45.0
stand_kd_nmsprad = 0.7
damping_kd_nmsprad = 1.1
kp_limit_nmprad = 90.0
kd_limit_nmsprad = 2.0
[limits]
speed_fault_radps = 44.0
power_w = 3000.0
[motor]
stall_torque_nm = 80.0
no_load_speed_radps = 20.0
continuous_torque_nm = 16.0
thermal_time_s = 15.0
)";

/// Links and joints of one leg; `front` and `left` are 1 or -1.
inline std::string small_robot_leg(const std::string& leg, double front, double left) {
  const auto link = [&](const char* name, double x_m, double y_m, double z_m, double mass_kg,
                        double inertia_kgm2, const char* collision) {
    return fmt::format(
        R"(<link name="{0}_{1}"><inertial><origin xyz="{2} {3} {4}"/><mass value="{5}"/>)"
        R"(<inertia ixx="{6}" ixy="0" ixz="0" iyy="{6}" iyz="0" izz="{6}"/></inertial>{7}</link>)",
        leg, name, x_m, y_m, z_m, mass_kg, inertia_kgm2, collision);
  };
  const auto joint = [&](const char* name, const std::string& parent, const char* child,
                         const std::string& at, const char* motion) {
    return fmt::format(R"(<joint name="{0}_{1}" type="{5}"><parent link="{2}"/>)"
                       R"(<child link="{0}_{3}"/><origin xyz="{4}"/>{6}</joint>)",
                       leg, name, parent, child, at, *motion ? "revolute" : "fixed", motion);
  };
  return link("hip", -0.008 * front, -0.02 * left, 0.0, 0.65, 5e-4, "") +
         link("upper", 0.0, -0.025 * left, -0.025, 0.95, 4e-3, "") +
         link("lower", 0.0, 0.0, -0.055, 0.15, 8e-4, "") +
         link("ball", 0.0, 0.0, 0.0, 0.03, 8e-6,
              R"(<collision><geometry><sphere radius="0.022"/></geometry></collision>)") +
         joint(
             "roll", "trunk", "hip", fmt::format("{} {} -0.03", 0.23 * front, 0.06 * left),
             R"(<axis xyz="1 0 0"/><limit lower="-0.9" upper="0.9" effort="31" velocity="17"/>)") +
         joint("pitch", leg + "_hip", "upper", fmt::format("0 {} 0", 0.065 * left),
               R"(<axis xyz="0 1 0"/><limit lower="-1.5" upper="3" effort="32" velocity="18"/>)") +
         joint(
             "knee", leg + "_upper", "lower", "0 0 -0.18",
             R"(<axis xyz="0 1 0"/><limit lower="-2.4" upper="-0.2" effort="33" velocity="19"/>)") +
         joint("ankle", leg + "_lower", "ball", "0 0 -0.18", "");
}

inline std::string small_robot_urdf() {
  return R"(<robot name="small"><link name="trunk"><inertial><origin xyz="0 0 -0.03"/>)"
         R"(<mass value="6.3"/><inertia ixx="0.03" ixy="0" ixz="0" iyy="0.09" iyz="0" )"
         R"(izz="0.11"/></inertial><collision><origin xyz="0 0 -0.03"/>)"
         R"(<geometry><box size="0.53 0.2 0.09"/></geometry></collision></link>)" +
         small_robot_leg("fl", 1.0, 1.0) + small_robot_leg("fr", 1.0, -1.0) +
         small_robot_leg("rl", -1.0, 1.0) + small_robot_leg("rr", -1.0, -1.0) + "</robot>";
}

/// Writes small.toml and small.urdf into `folder`; returns the path of the map.
inline std::string write_small_robot(const TemporaryFolder& folder) {
  write_file(folder.path("small.urdf"), small_robot_urdf());
  write_file(folder.path("small.toml"), kSmallRobotMap);
  return folder.path("small.toml");
}

}  // namespace sandrunner
