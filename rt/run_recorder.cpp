// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run_recorder.h"

#include <cmath>

namespace sandrunner {

RunSample make_sample(const sim::Simulator& simulator, const Lockstep& loop,
                      const StateEstimate& truth) {
  const sim::SimulatorState& state = simulator.state();
  const sim::RigidState<double>& x = state.robot.rigid;
  const sim::RobotModel<double>& model = simulator.model();
  const sim::StepReport<double>& report = simulator.truth().report;
  const auto array = [](const sim::Vec3<double>& v) { return Vector3{v.x, v.y, v.z}; };
  RunSample s;
  s.t_s = static_cast<double>(loop.input().sensors.tick) * kControlPeriod_s;
  s.mode = loop.output().mode;
  s.command = loop.output().policy_input.command;
  s.base_position_m = array(x.position);
  s.orientation_wxyz = {x.orientation.w, x.orientation.x, x.orientation.y, x.orientation.z};
  const sim::Mat3<double> r = sim::rotation_matrix(x.orientation);
  const double forward = std::sqrt(r.r0.x * r.r0.x + r.r1.x * r.r1.x);
  s.vx_mps = (r.r0.x * x.velocity.x + r.r1.x * x.velocity.y) / forward;
  s.vy_mps = (r.r0.x * x.velocity.y - r.r1.x * x.velocity.x) / forward;
  s.yaw_rate_radps = dot(r.r2, x.angular_velocity);
  s.joint_position_rad = x.q;
  s.joint_velocity_radps = x.qd;
  s.joint_torque_nm = state.torque_nm;
  for (int l = 0; l < kNumLegs; ++l) {
    const sim::LegModel<double>& leg = model.legs[l];
    const sim::LegPose<double> p = sim::leg_pose(leg, x.q[3 * l], x.q[3 * l + 1], x.q[3 * l + 2]);
    const auto world = [&](const sim::Vec3<double>& hip) {
      return array(x.position + r * sim::hip_to_base(leg, p, hip));
    };
    s.hip_position_m[l] = world(leg.hfe);
    s.knee_position_m[l] = world(p.knee);
    s.foot_position_m[l] = world(p.foot);
    s.penetration_m[l] = report.penetration[l];
    s.ground_height_m[l] =
        simulator.surface_height(s.foot_position_m[l][0], s.foot_position_m[l][1]);
    s.contact[l] = report.penetration[l] >= 0.0;
  }
  s.has_estimate = loop.policy_ran();
  if (s.has_estimate) s.estimate = loop.policy_output().estimate;
  s.truth = truth;
  return s;
}

}  // namespace sandrunner
