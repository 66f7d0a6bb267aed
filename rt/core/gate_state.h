// SPDX-License-Identifier: BSD-3-Clause
// What the safety gate remembers and counts.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "rt/core/faults.h"
#include "rt/core/imu_judge.h"
#include "rt/core/joint_judge.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// Ticks since the start in which ...
struct GateCounters {
  std::uint64_t joint_past_stop = 0;   ///< a joint was past its stop
  std::uint64_t joint_too_fast = 0;    ///< a joint was above the speed limit
  std::uint64_t tilted = 0;            ///< the body was tilted past the limit
  std::uint64_t hot = 0;               ///< a drive was near the torque that it can give for long
  std::uint64_t stalled = 0;           ///< the loop had missed ticks just before
  std::uint64_t joints_late = 0;       ///< a joint's values were older than their limit
  std::uint64_t imu_late = 0;          ///< the IMU sample was older than its limit
  std::uint64_t position_clamped = 0;  ///< a commanded position was clamped
  std::uint64_t velocity_clamped = 0;  ///< a commanded velocity was clamped
  std::uint64_t torque_clamped = 0;    ///< a joint command was moved to bound its torque
  std::uint64_t gains_clamped = 0;     ///< a gain was clamped
  std::uint64_t power_clamped = 0;     ///< joint commands were moved to bound the power
  std::uint64_t command_clamped = 0;   ///< the velocity command was brought inside the envelope
};

/// Names of the counters, for all who show them.
struct GateCounterName {
  const char* name;
  std::uint64_t GateCounters::* ticks;
};
inline constexpr std::array kGateCounters = {
    GateCounterName{"joint_past_stop", &GateCounters::joint_past_stop},
    GateCounterName{"joint_too_fast", &GateCounters::joint_too_fast},
    GateCounterName{"tilted", &GateCounters::tilted},
    GateCounterName{"hot", &GateCounters::hot},
    GateCounterName{"stalled", &GateCounters::stalled},
    GateCounterName{"joints_late", &GateCounters::joints_late},
    GateCounterName{"imu_late", &GateCounters::imu_late},
    GateCounterName{"position_clamped", &GateCounters::position_clamped},
    GateCounterName{"velocity_clamped", &GateCounters::velocity_clamped},
    GateCounterName{"torque_clamped", &GateCounters::torque_clamped},
    GateCounterName{"gains_clamped", &GateCounters::gains_clamped},
    GateCounterName{"power_clamped", &GateCounters::power_clamped},
    GateCounterName{"command_clamped", &GateCounters::command_clamped}};
static_assert(sizeof(GateCounters) == 8 * kGateCounters.size(), "every counter has a name");

/// Memory of the gate: what is latched, and counts since the start. All members 64 bits wide.
struct GateState {
  std::uint64_t faults = 0;          ///< latched bits of Fault
  Fault first_fault = Fault::kNone;  ///< that began the latest latch; kept over a reset
  std::uint64_t first_fault_tick = 0;
  /// Joints that a latched fault is about, bit j for joint j; kept over a reset.
  std::uint64_t fault_joints = 0;
  std::uint64_t blind_joints = 0;  ///< whose values a latched fault makes untrustworthy
  std::uint64_t tick = 0;          ///< of the latest judgement
  std::uint64_t judged = 0;        ///< judgements since the start
  Stall stall;
  std::uint64_t missed_ticks = 0;   ///< by the loop, less one for each that it ran since
  std::uint64_t tilted_ticks = 0;   ///< how long tilted past the limit
  std::uint64_t falling_ticks = 0;  ///< how long without weight

  JointArray<std::uint64_t> torque_over_ticks{};  ///< judged ticks in a row above the fault torque
  JointArray<double> heat_n2m2{};                 ///< squared torque, averaged over thermal_time_s
  ImuMemory imu;
  JointMemory joints;

  /// In which the latest judgement left the robot: the judged one, Fault after a fault, Passive
  /// after a reset.
  Mode mode = Mode::kPassive;
  std::uint64_t walk_tick = 0;  ///< of the latest judgement in Walk
  std::uint64_t walked = 0;     ///< 1: there was one

  JointArray<double> sent_rad{};    ///< the last commanded positions
  std::uint64_t sent = 0;           ///< 1: the last command had stiffness
  JointArray<double> action_rad{};  ///< of the policy's last step
  std::uint64_t action_sequence = 0, action_episode = 0;
  std::uint64_t same_actions = 0;  ///< steps in a row with the same bits

  GateCounters counters;
};
static_assert(std::is_trivially_copyable_v<GateState>);
static_assert(sizeof(GateState) == 8 * (19 + 4 * kNumJoints) + sizeof(ImuMemory) +
                                       sizeof(JointMemory) + sizeof(GateCounters),
              "no padding");

}  // namespace sandrunner
