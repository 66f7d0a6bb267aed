// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_observer.h"

#include <cmath>
#include <utility>

namespace sandrunner {
namespace {

constexpr std::uint64_t kProgress_ticks = kControlHz / 2;

RunSample make_sample(const sim::Simulator& simulator, const TickRecord& tick) {
  const RobotTruth& now = tick.truth;
  const auto array = [](const sim::Vec3<double>& v) { return Vector3{v.x, v.y, v.z}; };
  RunSample s;
  s.t_s = static_cast<double>(tick.input.sensors.tick) * kControlPeriod_s;
  s.mode = tick.output.mode;
  s.command = tick.output.policy_input.command;
  s.base_position_m = now.position_m;
  s.orientation_wxyz = now.orientation_wxyz;
  const auto& q = now.orientation_wxyz;
  const auto& v = now.velocity_mps;
  const sim::Vec3<double> position{now.position_m[0], now.position_m[1], now.position_m[2]};
  const sim::Mat3<double> r =
      sim::rotation_matrix(sim::Quaternion<double>{q[0], q[1], q[2], q[3]});
  const double forward = std::sqrt(r.r0.x * r.r0.x + r.r1.x * r.r1.x);
  s.vx_mps = (r.r0.x * v[0] + r.r1.x * v[1]) / forward;
  s.vy_mps = (r.r0.x * v[1] - r.r1.x * v[0]) / forward;
  const auto& w = now.angular_velocity_radps;
  s.yaw_rate_radps = dot(r.r2, sim::Vec3<double>{w[0], w[1], w[2]});
  s.joint_position_rad = now.joint_position_rad;
  s.joint_velocity_radps = now.joint_velocity_radps;
  s.joint_torque_nm = now.joint_torque_nm;
  for (int l = 0; l < kNumLegs; ++l) {
    const sim::LegModel<double>& leg = simulator.model().legs[l];
    const auto& joints = now.joint_position_rad;
    const sim::LegPose<double> p = sim::leg_pose(leg, joints[3 * l], joints[3 * l + 1], joints[3 * l + 2]);
    const auto world = [&](const sim::Vec3<double>& hip) {
      return array(position + r * sim::hip_to_base(leg, p, hip));
    };
    s.hip_position_m[l] = world(leg.hfe);
    s.knee_position_m[l] = world(p.knee);
    s.foot_position_m[l] = world(p.foot);
    s.penetration_m[l] = now.foot_penetration_m[l];
    s.ground_height_m[l] =
        simulator.surface_height(s.foot_position_m[l][0], s.foot_position_m[l][1]);
    s.contact[l] = now.foot_penetration_m[l] >= 0.0;
  }
  s.truth = tick.before.state;
  return s;
}

}  // namespace

RunObserver::RunObserver(const ProcessConfig& config, const sim::Simulator& simulator,
                         const std::string& policy_name, bool keep_record,
                         std::function<void(const RunSample&)> progress)
    : simulator_(simulator),
      motor_constant_(config.motor_constant),
      keep_record_(keep_record),
      progress_(std::move(progress)) {
  if (!keep_record) return;
  record_.terrain = config.simulator.terrain.name;
  record_.policy = policy_name;
  record_.granular_ground =
      config.simulator.terrain.patches.front().ground.kind == sim::GroundKind::kGranular;
  const sim::RobotModel<double>& model = simulator_.model();
  record_.base_box_size_m = {2 * model.base_box_half_m.x, 2 * model.base_box_half_m.y,
                             2 * model.base_box_half_m.z};
  record_.base_box_center_m = {model.base_box_centre_m.x, model.base_box_centre_m.y,
                               model.base_box_centre_m.z};
  record_.foot_radius_m = model.foot_radius_m;
  if (simulator_.terrain().highest > 0.0) {
    record_.ground_height_m = [terrain = simulator](double x, double y) {
      return terrain.surface_height(x, y);
    };
  }
}

void RunObserver::add(const TickRecord& tick) {
  const PolicyOutput& policy = tick.input.policy;
  const bool answered = policy.sequence != policy_sequence_;
  policy_sequence_ = policy.sequence;
  const bool comparable = answered && released_ && policy.input_tick == released_tick_;
  if (comparable && !record_.samples.empty() &&
      ticks_from_s(record_.samples.back().t_s) == released_tick_) {
    record_.samples.back().has_estimate = true;
    record_.samples.back().estimate = policy.estimate;
  }
  statistics_.add(tick, comparable ? &released_truth_ : nullptr);
  if (tick.output.release_policy != 0) {
    released_ = true;
    released_tick_ = tick.input.sensors.tick;
    released_truth_ = tick.before.state;
  }
  const std::uint64_t number = tick.input.sensors.tick;
  const bool show = number % kProgress_ticks == 0 && progress_;
  if (number % kTicksPerPolicyStep != 0 || !(keep_record_ || show)) return;
  const RunSample sample = make_sample(simulator_, tick);
  if (show) progress_(sample);
  if (keep_record_) record_.samples.push_back(sample);
}

RunFigures RunObserver::figures() const {
  return statistics_.figures(simulator_.model().mass(), motor_constant_);
}

RunRecord RunObserver::take_record() {
  record_.footprints = statistics_.footprints();
  return std::move(record_);
}

}  // namespace sandrunner
