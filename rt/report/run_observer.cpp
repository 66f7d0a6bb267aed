// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_observer.h"

#include <utility>

#include "rt/report/body_motion.h"

namespace sandrunner {
namespace {

constexpr std::size_t kMostSamples = 1 << 16;  // 11 minutes at the policy's rate; 60 MB

}  // namespace

RunObserver::RunObserver(RunScene scene, bool keep_record,
                         std::function<void(const RunSample&)> progress)
    : keep_record_(keep_record), progress_(std::move(progress)) {
  record_.scene = std::move(scene);
}

RunSample RunObserver::make_sample(const TickRecord& tick) const {
  const SensorFrame& sensors = tick.input.sensors;
  RunSample s;
  s.t_s = static_cast<double>(sensors.tick) * kControlPeriod_s;
  s.mode = tick.output.mode;
  s.command = tick.output.policy_input.command;
  if (tick.has_truth == 0) {
    s.orientation_wxyz = sensors.imu.orientation_wxyz;
    s.yaw_rate_radps =
        body_motion(s.orientation_wxyz, {}, sensors.imu.angular_velocity_radps).yaw_rate_radps;
    s.joint_position_rad = sensors.joints.position_rad;
    s.joint_velocity_radps = sensors.joints.velocity_radps;
    s.joint_torque_nm = sensors.joints.torque_nm;
    return s;
  }
  const RobotTruth& now = tick.truth;
  s.has_truth = true;
  s.base_position_m = now.position_m;
  s.orientation_wxyz = now.orientation_wxyz;
  const BodyMotion motion =
      body_motion(now.orientation_wxyz, now.velocity_mps, now.angular_velocity_radps);
  s.vx_mps = motion.vx_mps;
  s.vy_mps = motion.vy_mps;
  s.yaw_rate_radps = motion.yaw_rate_radps;
  s.joint_position_rad = now.joint_position_rad;
  s.joint_velocity_radps = now.joint_velocity_radps;
  s.joint_torque_nm = now.joint_torque_nm;
  s.truth = tick.before.state;
  const RunScene& scene = record_.scene;
  const std::array<Vector3, 3> axes = body_axes(now.orientation_wxyz);
  const auto world = [&](const Vector3& in_base) {
    Vector3 p = to_world(axes, in_base);
    for (std::size_t k = 0; k < 3; ++k) p[k] += now.position_m[k];
    return p;
  };
  const std::array<LegPoints, kNumLegs> legs = scene.leg_points(now.joint_position_rad);
  for (std::size_t l = 0; l < kNumLegs; ++l) {
    s.hip_position_m[l] = world(legs[l].hip);
    s.knee_position_m[l] = world(legs[l].knee);
    s.foot_position_m[l] = world(legs[l].foot);
    s.penetration_m[l] = now.foot_penetration_m[l];
    s.ground_height_m[l] = scene.ground_height_m ? scene.ground_height_m(s.foot_position_m[l][0],
                                                                         s.foot_position_m[l][1])
                                                 : 0.0;
    s.contact[l] = now.foot_penetration_m[l] >= 0.0;
  }
  return s;
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
  statistics_.add(tick, comparable && tick.has_truth != 0 ? &released_truth_ : nullptr);
  if (tick.output.release_policy != 0) {
    released_ = true;
    released_tick_ = tick.input.sensors.tick;
    released_truth_ = tick.before.state;
  }
  const std::uint64_t number = tick.input.sensors.tick;
  if (progress_rate_.due(number) && progress_) progress_(make_sample(tick));
  if (sample_rate_.due(number) && keep_record_) keep(make_sample(tick));
}

// Every period of the policy, or where that would be too many every second, fourth, ...
void RunObserver::keep(const RunSample& sample) {
  if (periods_ % periods_a_sample_ == 0) record_.samples.push_back(sample);
  ++periods_;
  if (record_.samples.size() < kMostSamples) return;
  for (std::size_t i = 0; i < kMostSamples / 2; ++i) record_.samples[i] = record_.samples[2 * i];
  record_.samples.resize(kMostSamples / 2);
  periods_a_sample_ *= 2;
}

RunFigures RunObserver::figures() const {
  return statistics_.figures(record_.scene.mass_kg, record_.scene.motor_constant);
}

RunRecord RunObserver::take_record() {
  const std::deque<Footprint>& footprints = statistics_.footprints();
  record_.footprints.assign(footprints.begin(), footprints.end());
  return std::move(record_);
}

}  // namespace sandrunner
