// SPDX-License-Identifier: BSD-3-Clause
// What a browser is shown of a run: frames at the policy's rate, footprints, and the one
// description of their layout, which is said to the page too.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimator/odometry.h"
#include "rt/core/robot_description.h"
#include "rt/core/slower_rate.h"
#include "rt/loop/tick_record.h"
#include "rt/report/run_record.h"
#include "rt/report/stances.h"

namespace sandrunner {

/// Some numbers of a row, side by side; little-endian.
struct ViewField {
  const char* name;
  const char* type;  ///< "f64", "f32", "u32", "i32" or "i16"
  std::size_t offset, count;

  /// Of one of the numbers, bytes.
  std::size_t width() const noexcept;
};

/// Bits of ViewFrame::flags.
inline constexpr std::uint32_t kViewHasTruth = 1, kViewHasEstimate = 2;

/// One moment, at the first tick of each of the policy's periods. World frame, legs and joints as
/// in messages.h. Without truth (hardware) the pose is that of the odometry, joints are as
/// measured, and what only a simulator knows is NaN.
struct ViewFrame {
  double t_s = 0.0;
  Vector3 position_m{};            ///< of the base origin
  std::array<double, 3> odometry;  ///< dead-reckoned x, y, yaw; m, rad
  std::array<float, 4> orientation_wxyz;
  JointArray<float> position_rad, velocity_radps;
  JointArray<float> peak_torque_nm;  ///< of largest size since the frame before, with its sign
  std::array<float, kNumLegs> penetration_m;
  std::array<std::array<float, 3>, kNumLegs> foot_force_n;  ///< of the ground on the foot
  /// x, y, depth where the foot is deepest so far in its present stance; depth 0: in the air.
  std::array<std::array<float, 3>, kNumLegs> stance_m;
  std::array<float, 3> asked, given;   ///< command by the operator, and as the policy gets it
  std::array<float, 3> motion;         ///< vx, vy in the heading frame, yaw rate
  std::array<float, 8> estimate;       ///< of this frame's sensors: StateEstimate; NaN: none
  std::array<float, 8> truth;          ///< what `estimate` should be
  float power_w, torque_squared_nm2;   ///< sums over joints, mean since the frame before
  float late_us, control_us, tick_us;  ///< worst since the frame before; 0 in lockstep
  std::uint32_t mode, faults, flags;
  std::uint32_t skipped;  ///< ticks missed so far
};

/// What a foot left in soft ground when its stance ended.
struct ViewFootprint {
  double t_s = 0.0;
  double x_m = 0.0, y_m = 0.0;  ///< where the foot was deepest
  float depth_m = 0.0f;
  std::uint32_t leg = 0;
};

std::span<const ViewField> view_frame_fields();
std::span<const ViewField> view_footprint_fields();

/// Ticks into frames and footprints. Ordinary threads; the order of the ticks matters, gaps do not.
class ViewFrameMaker {
 public:
  explicit ViewFrameMaker(const RobotDescription& robot) : odometry_(robot) {}

  /// The frame that this tick completes, if any. A frame waits for the network's answer to its own
  /// sensors, so it comes a tick or a few later; at the latest when the next one begins.
  std::optional<ViewFrame> add(const TickRecord& tick);
  /// The frame that still waits.
  std::optional<ViewFrame> take_last();

  /// Footprints since the last call.
  std::vector<ViewFootprint> take_footprints();

 private:
  void follow_stances(const TickRecord& tick);
  void follow_extremes(const TickRecord& tick);
  ViewFrame make_frame(const TickRecord& tick) const;

  SlowerRate rate_{kPolicyHz};
  Odometry odometry_;
  StanceWatch stances_;
  std::vector<ViewFootprint> footprints_;
  std::optional<ViewFrame> waiting_;
  std::uint64_t waiting_tick_ = 0, policy_sequence_ = 0;
  std::uint32_t skipped_ = 0;
  // Since the frame before.
  int ticks_ = 0;
  JointArray<double> peak_torque_nm_{};
  double power_w_ = 0.0, torque_squared_nm2_ = 0.0;
  TickTiming worst_;
  std::int64_t worst_tick_ns_ = 0;
};

}  // namespace sandrunner
