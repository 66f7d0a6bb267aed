// SPDX-License-Identifier: BSD-3-Clause
#include "tools/python/record_types.h"

namespace sandrunner::python {
namespace {

py::dtype body_type() {
  using B = sim::Body<float>;
  return RecordType<float>(sizeof(B))
      .add("mass", offsetof(B, mass))
      .add("com", offsetof(B, com), 3)
      .add("inertia", offsetof(B, inertia), 6)
      .dtype();
}

py::dtype leg_type() {
  using L = sim::LegModel<float>;
  const py::dtype body = body_type();
  return RecordType<float>(sizeof(L))
      .add("sign", offsetof(L, sign), 3)
      .add("haa", offsetof(L, haa), 3)
      .add("hfe", offsetof(L, hfe), 3)
      .add("kfe", offsetof(L, kfe), 3)
      .add("foot", offsetof(L, foot), 3)
      .add_table("patch", offsetof(L, patch), sim::kMaxFootPatches, 3)
      .add_struct("hip", offsetof(L, hip), body)
      .add_struct("thigh", offsetof(L, thigh), body)
      .add_struct("shank", offsetof(L, shank), body)
      .dtype();
}

}  // namespace

py::dtype state_type() {
  using T = sim::RobotState<float>;
  using R = sim::RigidState<float>;
  constexpr std::size_t kRigid = offsetof(T, rigid);
  return RecordType<float>(sizeof(T))
      .add("position", kRigid + offsetof(R, position), 3)
      .add("orientation", kRigid + offsetof(R, orientation), 4)
      .add("joint_position", kRigid + offsetof(R, q), kNumJoints)
      .add("velocity", kRigid + offsetof(R, velocity), 3)
      .add("angular_velocity", kRigid + offsetof(R, angular_velocity), 3)
      .add("joint_velocity", kRigid + offsetof(R, qd), kNumJoints)
      .add_struct("contacts", offsetof(T, feet), contact_type<float>(), kNumLegs)
      .add_table("impulse", offsetof(T, impulse), sim::kNumPoints, 3)
      .add("stop_impulse", offsetof(T, stop_impulse), kNumJoints)
      .add_struct("further_contacts", offsetof(T, further_feet), contact_type<float>(),
                  sim::kNumFurtherPatches)
      .add_table("further_impulse", offsetof(T, further_impulse), sim::kNumFurtherPatches, 3)
      .dtype();
}

py::dtype model_type() {
  using M = sim::RobotModel<float>;
  return RecordType<float>(sizeof(M))
      .add_struct("base", offsetof(M, base), body_type())
      .add_struct("legs", offsetof(M, legs), leg_type(), kNumLegs)
      .add("rotor_inertia", offsetof(M, rotor_inertia), kNumJoints)
      .add("friction_nm", offsetof(M, friction_nm), kNumJoints)
      .add("lower_rad", offsetof(M, lower_rad), kNumJoints)
      .add("upper_rad", offsetof(M, upper_rad), kNumJoints)
      .add("torque_limit_nm", offsetof(M, torque_limit_nm), kNumJoints)
      .add("speed_limit_radps", offsetof(M, speed_limit_radps), kNumJoints)
      .add("foot_radius_m", offsetof(M, foot_radius_m))
      .add("foot_width_m", offsetof(M, foot_width_m))
      .add("foot_length_m", offsetof(M, foot_length_m))
      .add("foot_patches", offsetof(M, foot_patches))
      .add("knee_radius_m", offsetof(M, knee_radius_m))
      .add("shank_radius_m", offsetof(M, shank_radius_m))
      .add("base_box_centre_m", offsetof(M, base_box_centre_m), 3)
      .add("base_box_half_m", offsetof(M, base_box_half_m), 3)
      .dtype();
}

py::dtype drive_type() {
  using D = sim::BatchDrive<float>;
  using L = sim::DriveLine<float>;
  constexpr std::size_t kLine = offsetof(D, line);
  return RecordType<float>(sizeof(D))
      .add("target_before", offsetof(D, target_before), kNumJoints)
      .add("target", offsetof(D, target), kNumJoints)
      .add("switch_tick", offsetof(D, switch_tick))
      .add("kp", offsetof(D, kp))
      .add("kd", offsetof(D, kd))
      .add("torque_scale", offsetof(D, torque_scale))
      .add("stall_torque_nm", kLine + offsetof(L, stall_torque_nm), kJointsPerLeg)
      .add("inverse_no_load_speed", kLine + offsetof(L, inverse_no_load_speed), kJointsPerLeg)
      .add("heat_factor", offsetof(D, heat_factor), kJointsPerLeg)
      .dtype();
}

py::dtype report_type() {
  using R = sim::BatchReport<float>;
  return RecordType<float>(sizeof(R))
      .add_table("foot_velocity", offsetof(R, foot_velocity), kNumLegs, 3)
      .add("penetration", offsetof(R, penetration), kNumLegs)
      .add_table("foot_force", offsetof(R, foot_force), kNumLegs, 3)
      .dtype();
}

py::dtype sums_type() {
  using T = sim::BatchSums<float>;
  return RecordType<float>(sizeof(T))
      .add("torque_squared", offsetof(T, torque_squared))
      .add("power", offsetof(T, power))
      .add("extension_power", offsetof(T, extension_power))
      .add("speed_squared", offsetof(T, speed_squared))
      .add("speed_excess", offsetof(T, speed_excess))
      .add("ticks_too_fast", offsetof(T, ticks_too_fast))
      .add("ticks_past_stop", offsetof(T, ticks_past_stop))
      .add("slip", offsetof(T, slip))
      .add("foot_load", offsetof(T, foot_load), kNumLegs)
      .add("base_contact", offsetof(T, base_contact))
      .add("thigh_contact", offsetof(T, thigh_contact))
      .dtype();
}

}  // namespace sandrunner::python
