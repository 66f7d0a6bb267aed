// SPDX-License-Identifier: BSD-3-Clause
// The robot as the simulator knows it: a floating base and four legs of three revolute joints with
// axes x, y, y (HAA, HFE, KFE), either way, and a foot fixed to the shank. One value of every
// figure for one robot, or one in each lane of a pack, so that masses and geometry can be
// randomised robot by robot.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "rt/core/messages.h"
#include "rt/core/robot_description.h"
#include "sim/lanes/vec.h"

namespace sandrunner {
struct SettingLine;  // rt/base/settings.h
}

namespace sandrunner::sim {

/// A rigid body: mass (kg), centre of mass (m) and inertia about it (kg m^2), in the frame of its
/// link.
template <typename S>
struct Body {
  S mass{};
  Vec3<S> com;
  Sym3<S> inertia;
};

inline constexpr int kMaxFootPatches = 4;

/// One leg: three joints in a row, hip abduction (HAA, about x), hip flexion (HFE, about y), knee
/// flexion (KFE, about y). With all joints at zero the link frames are parallel to the base's,
/// however the URDF turns its own.
template <typename S>
struct LegModel {
  std::array<S, kJointsPerLeg> sign{S(1.0), S(1.0), S(1.0)};  ///< -1: about -x, -y, -y
  Vec3<S> haa;                                                ///< HAA origin in the base frame, m
  Vec3<S> hfe;                                                ///< HFE origin in the hip frame, m
  Vec3<S> kfe;                                                ///< KFE origin in the thigh frame, m
  Vec3<S> foot;                                               ///< foot centre in the shank frame, m
  std::array<Vec3<S>, kMaxFootPatches> patch{};  ///< of the foot, from its centre, shank frame, m
  Body<S> hip;                                   ///< between HAA and HFE
  Body<S> thigh;                                 ///< between HFE and KFE
  Body<S> shank;                                 ///< below KFE, with the foot
};

/// Speed of a joint, rad/s, below which its dry friction is proportional to its speed: a joint that
/// jumps from one friction to the opposite one has no rest that steps of the simulation can find.
inline constexpr double kFrictionSpeed_radps = 0.1;

template <typename S>
struct RobotModel {
  Body<S> base;
  std::array<LegModel<S>, kNumLegs> legs;
  std::array<S, kNumJoints> rotor_inertia{};  ///< reflected to the joint, kg m^2
  /// Dry friction, N m: against the joint's motion, in full from kFrictionSpeed_radps on.
  std::array<S, kNumJoints> friction_nm{};
  std::array<S, kNumJoints> lower_rad{}, upper_rad{};  ///< stops
  std::array<S, kNumJoints> torque_limit_nm{}, speed_limit_radps{};
  S foot_radius_m{};        ///< of the tyre or ball; of a sole half its thickness
  S foot_width_m{};         ///< of the tyre or sole; 0: a ball
  S foot_length_m{};        ///< of a flat sole; 0: a tyre or ball
  S foot_patches = S(1.0);  ///< points of a foot that touch the ground
  S knee_radius_m{};        ///< of the thigh's lower end
  S shank_radius_m{};       ///< half the thickness of the shank
  Vec3<S> base_box_centre_m, base_box_half_m;  ///< collision box, base frame

  /// Total mass, kg.
  S mass() const noexcept {
    S m = base.mass;
    for (const auto& leg : legs) m = m + (leg.hip.mass + leg.thigh.mass + leg.shank.mass);
    return m;
  }
};

/// Electrical limit of a drive, seen at the joint: |torque| <= stall torque (1 - |speed| / no-load
/// speed) while it drives in the direction of motion. A stall torque of 0: no such limit.
struct TorqueSpeedLine {
  LegJoints<double> stall_torque_nm{};
  LegJoints<double> no_load_speed_radps{};
};

/// A RobotModel and the other figures of its robot file that controller and program need
/// (sim/robot/README.md explains each).
struct Robot {
  RobotDescription description;
  std::string map;  ///< text of its robot file, as read
  RobotModel<double> model;
  JointArray<double> nominal_rad{};  ///< posture of Stand; pose of `--start walk`
  double nominal_height_m = 0.0;     ///< base height in that pose, feet just touching
  JointArray<double> lying_rad{};    ///< pose in which it lies on its belly
  /// Pose of each leg from which it stands up.
  LegJoints<double> fold_rad{};
  double stand_kp_nmprad = 0.0;  ///< gains of StandUp and Stand
  double stand_kd_nmsprad = 0.0;
  LegJoints<double> damping_kd_nmsprad{};  ///< gain of Damping, and of the damping after a fault
  double kp_limit_nmprad = 0.0;            ///< largest gains that the drives are to be given
  double kd_limit_nmsprad = 0.0;
  LegJoints<double> speed_fault_radps{};  ///< a joint measured above it is a fault
  double power_limit_w = 0.0;             ///< mechanical power of all joints together
  LegJoints<double>
      continuous_torque_nm{};   ///< rms torque that a drive gives for ever, at the joint
  double thermal_time_s = 0.0;  ///< time constant with which its windings warm
  TorqueSpeedLine torque_speed_line;
  /// Whether simulated drives obey that line unless a setting says otherwise.
  bool obeys_torque_speed_line = false;
  /// k_m at the joint: a torque heats the motor by torque^2 / k_m^2, in W.
  LegJoints<double> motor_constant_nmpsqrtw{};
};

/// The default robot (sim/robot/raibo.urdf and raibo.toml, embedded in the program).
Robot load_raibo();

/// Loads a quadruped of this topology. `map_path` is the name of a robot that ships, "raibo" or
/// "go2", or the path of a TOML file that names the links and joints of
/// the URDF and gives what a URDF cannot (sim/robot/README.md); a relative `urdf` in it is looked
/// up next to the robot file. Throws InputError, one line, for anything that is not such a robot.
Robot load_robot(const std::string& map_path);

/// As load_robot, from texts; `map_name` and `urdf_name` appear in errors.
Robot parse_robot(const std::string& map_text, const std::string& map_name,
                  const std::string& urdf_text, const std::string& urdf_name);

/// The keys of a robot's file, for the reference.
std::vector<SettingLine> robot_file_settings();

/// The same figures in another scalar (one robot in float, or all lanes alike).
template <typename To>
RobotModel<To> convert_model(const RobotModel<double>& from) noexcept {
  return converted<To>(from);
}

}  // namespace sandrunner::sim
