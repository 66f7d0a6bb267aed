// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

#include "rt/report/body_motion.h"
#include "rt/report/joint_power.h"

namespace sandrunner {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr double kShallowest_m = 0.002;  // hard ground takes no footprint

template <typename T>
struct Element {
  using Type = T;
  static constexpr std::size_t kCount = 1;
};
template <typename T, std::size_t kSize>
struct Element<std::array<T, kSize>> : Element<T> {
  static constexpr std::size_t kCount = kSize * Element<T>::kCount;
};

template <typename Member>
constexpr ViewField field(const char* name, std::size_t offset) {
  using Type = typename Element<Member>::Type;
  static_assert(std::is_same_v<Type, double> || std::is_same_v<Type, float> ||
                std::is_same_v<Type, std::uint32_t>);
  const char* type = std::is_same_v<Type, double>  ? "f64"
                     : std::is_same_v<Type, float> ? "f32"
                                                   : "u32";
  return {name, type, offset, Element<Member>::kCount};
}

// The compiler finds place, size and type of a member: a name cannot stand for another's values.
#define FRAME(member) field<decltype(ViewFrame::member)>(#member, offsetof(ViewFrame, member))
#define FOOTPRINT(member) \
  field<decltype(ViewFootprint::member)>(#member, offsetof(ViewFootprint, member))

constexpr std::array kFrameFields = {
    FRAME(t_s),
    FRAME(position_m),
    FRAME(odometry),
    FRAME(orientation_wxyz),
    FRAME(position_rad),
    FRAME(velocity_radps),
    FRAME(peak_torque_nm),
    FRAME(penetration_m),
    FRAME(foot_force_n),
    FRAME(stance_m),
    FRAME(asked),
    FRAME(given),
    FRAME(motion),
    FRAME(estimate),
    FRAME(truth),
    FRAME(power_w),
    FRAME(torque_squared_nm2),
    FRAME(late_us),
    FRAME(control_us),
    FRAME(tick_us),
    FRAME(mode),
    FRAME(faults),
    FRAME(flags),
    FRAME(skipped),
};
constexpr std::array kFootprintFields = {FOOTPRINT(t_s), FOOTPRINT(x_m), FOOTPRINT(y_m),
                                         FOOTPRINT(depth_m), FOOTPRINT(leg)};
#undef FRAME
#undef FOOTPRINT

template <std::size_t kSize>
std::array<float, kSize> floats(const std::array<double, kSize>& from) {
  std::array<float, kSize> to;
  for (std::size_t i = 0; i < kSize; ++i) to[i] = static_cast<float>(from[i]);
  return to;
}

std::array<float, 3> floats(const VelocityCommand& c) {
  return floats(std::array{c.vx_mps, c.vy_mps, c.wz_radps});
}

std::array<float, 8> floats(const StateEstimate& e) {
  return floats(std::array{e.body_height_m, e.velocity_mps[0], e.velocity_mps[1], e.velocity_mps[2],
                           e.foot_height_m[0], e.foot_height_m[1], e.foot_height_m[2],
                           e.foot_height_m[3]});
}

float micro(std::int64_t ns) { return 1e-3f * static_cast<float>(ns); }

}  // namespace

std::size_t ViewField::width() const noexcept {
  const std::string_view bits = type + 1;
  return bits == "64" ? 8 : bits == "32" ? 4 : 2;
}

std::span<const ViewField> view_frame_fields() { return kFrameFields; }
std::span<const ViewField> view_footprint_fields() { return kFootprintFields; }

void ViewFrameMaker::follow_stances(const TickRecord& tick) {
  stances_.add(tick, [&](std::size_t leg, double time_s, const Stance& stance) {
    if (stance.deepest_m[2] < kShallowest_m) return;
    footprints_.push_back({.t_s = time_s,
                           .x_m = stance.deepest_m[0],
                           .y_m = stance.deepest_m[1],
                           .depth_m = static_cast<float>(stance.deepest_m[2]),
                           .leg = static_cast<std::uint32_t>(leg)});
  });
}

void ViewFrameMaker::follow_extremes(const TickRecord& tick) {
  const bool truth = tick.has_truth != 0;
  const JointState& joints = tick.input.sensors.joints;
  const JointArray<double>& torque = truth ? tick.truth.joint_torque_nm : joints.torque_nm;
  const JointPower power = joint_power(tick);
  power_w_ += power.mechanical_w;
  torque_squared_nm2_ += power.torque_squared_nm2;
  ++ticks_;
  for (std::size_t j = 0; j < kNumJoints; ++j) {
    if (std::abs(torque[j]) > std::abs(peak_torque_nm_[j])) peak_torque_nm_[j] = torque[j];
  }
  const TickTiming& t = tick.timing;
  worst_.late_ns = std::max(worst_.late_ns, t.late_ns);
  worst_.control_ns = std::max(worst_.control_ns, t.control_ns);
  worst_tick_ns_ = std::max(worst_tick_ns_, t.read_ns + t.control_ns + t.write_ns);
  skipped_ += static_cast<std::uint32_t>(tick.skipped);
}

ViewFrame ViewFrameMaker::make_frame(const TickRecord& tick) const {
  const SensorFrame& sensors = tick.input.sensors;
  const bool truth = tick.has_truth != 0;
  const double share = 1.0 / ticks_;
  const auto [w, x, y, z] = odometry_.orientation_wxyz();
  ViewFrame f{};
  f.t_s = static_cast<double>(sensors.tick) * kControlPeriod_s;
  f.odometry = {odometry_.position_m()[0], odometry_.position_m()[1],
                std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))};
  f.peak_torque_nm = floats(peak_torque_nm_);
  f.asked = floats(tick.input.command.velocity);
  f.given = floats(tick.output.policy_input.command);
  f.estimate.fill(kUnknown);
  f.power_w = static_cast<float>(share * power_w_);
  f.torque_squared_nm2 = static_cast<float>(share * torque_squared_nm2_);
  f.late_us = micro(worst_.late_ns);
  f.control_us = micro(worst_.control_ns);
  f.tick_us = micro(worst_tick_ns_);
  f.mode = static_cast<std::uint32_t>(tick.output.mode);
  f.faults = static_cast<std::uint32_t>(tick.output.faults);
  f.flags = truth ? kViewHasTruth : 0;
  f.skipped = skipped_;
  if (!truth) {
    const BodyMotion motion =
        body_motion(sensors.imu.orientation_wxyz, {}, sensors.imu.angular_velocity_radps);
    f.position_m = odometry_.position_m();
    f.orientation_wxyz = floats(odometry_.orientation_wxyz());
    f.position_rad = floats(sensors.joints.position_rad);
    f.velocity_radps = floats(sensors.joints.velocity_radps);
    f.penetration_m.fill(kUnknown);
    for (auto& force : f.foot_force_n) force.fill(kUnknown);
    for (auto& stance : f.stance_m) stance.fill(kUnknown);
    f.motion = {kUnknown, kUnknown, static_cast<float>(motion.yaw_rate_radps)};
    f.truth.fill(kUnknown);
    return f;
  }
  const RobotTruth& now = tick.truth;
  const BodyMotion motion =
      body_motion(now.orientation_wxyz, now.velocity_mps, now.angular_velocity_radps);
  f.position_m = now.position_m;
  f.orientation_wxyz = floats(now.orientation_wxyz);
  f.position_rad = floats(now.joint_position_rad);
  f.velocity_radps = floats(now.joint_velocity_radps);
  f.penetration_m = floats(now.foot_penetration_m);
  for (std::size_t l = 0; l < kNumLegs; ++l) {
    f.foot_force_n[l] = floats(now.foot_force_n[l]);
    f.stance_m[l] = floats(stances_.stances()[l].deepest_m);
  }
  f.motion = floats(std::array{motion.vx_mps, motion.vy_mps, motion.yaw_rate_radps});
  f.truth = floats(tick.before.state);
  return f;
}

std::optional<ViewFrame> ViewFrameMaker::add(const TickRecord& tick) {
  odometry_.add(tick.input, tick.output);
  if (tick.has_truth != 0) follow_stances(tick);
  follow_extremes(tick);
  std::optional<ViewFrame> complete;
  const PolicyOutput& policy = tick.input.policy;
  if (waiting_ && policy.sequence != policy_sequence_ && policy.input_tick == waiting_tick_) {
    waiting_->estimate = floats(policy.estimate);
    waiting_->flags |= kViewHasEstimate;
    complete = std::exchange(waiting_, std::nullopt);
  }
  policy_sequence_ = policy.sequence;
  if (!rate_.due(tick.input.sensors.tick)) return complete;
  if (waiting_) complete = waiting_;
  waiting_ = make_frame(tick);
  waiting_tick_ = tick.input.sensors.tick;
  ticks_ = 0;
  peak_torque_nm_ = {};
  power_w_ = torque_squared_nm2_ = 0.0;
  worst_ = {};
  worst_tick_ns_ = 0;
  return complete;
}

std::optional<ViewFrame> ViewFrameMaker::take_last() {
  return std::exchange(waiting_, std::nullopt);
}

std::vector<ViewFootprint> ViewFrameMaker::take_footprints() {
  return std::exchange(footprints_, {});
}

}  // namespace sandrunner
