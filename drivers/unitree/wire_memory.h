// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

#include "drivers/unitree/state_watch.h"
#include "rt/core/triple_buffer.h"

namespace sandrunner::unitree {

/// The controller's command for the wire.
struct WireCommand {
  JointCommand joints;
  std::uint64_t enabled = 0;       ///< 0: motors off
  std::uint64_t blind_joints = 0;  ///< get no torque, bit j for joint j
  std::int64_t written_ns = 0;     ///< CLOCK_MONOTONIC, which all processes share
};

/// What the wire knows of the robot.
struct WireReport {
  RobotState state;  ///< the newest one
  std::int64_t sampled_ns = 0;
  StateCounters counters;
};

enum class WirePhase : std::uint8_t {
  kForked,
  kStarting,
  kReady,   ///< the robot is there; commands are sent
  kFailed,  ///< `error` says why
  kEnded    ///< nothing will be sent any more
};

/// What the controller and the wire, two processes, share. Each member has one writer. No side ever
/// waits for the other, and a side that is killed in the middle of a write leaves the last value.
struct WireMemory {
  TripleBuffer<WireCommand> command;  // of the controller

  TripleBuffer<WireReport> report;  // of the wire
  std::atomic<WirePhase> phase{WirePhase::kForked};
  std::atomic<bool> foreign{false};  ///< another program commands the robot
  std::atomic<bool> gave_up{false};  ///< the controller is not followed any more
  std::atomic<std::uint64_t> foreign_commands{0}, sent{0}, not_sent{0};
  std::atomic<std::uint64_t> turns{0};  ///< of its loop; none: it hangs
  std::atomic<bool> real_time{false};   ///< it got a real-time priority
  std::atomic<bool> powered{false};     ///< its command gives torque; false once it left the motors
  std::atomic<pid_t> sender{0};         ///< the process that sends; of the guard
  std::atomic<bool> guarding{false};    ///< that process died, and the guard damps; of the guard
  std::array<char, 1000> error{};       ///< written before `phase` becomes kFailed

  std::atomic<bool> start{false};  // of the controller
  std::atomic<bool> cut{false};    ///< from any thread of it
  std::atomic<bool> ended{false};  ///< it has let the robot down and ends
};
static_assert(std::is_trivially_copyable_v<WireCommand>);
static_assert(std::is_trivially_copyable_v<WireReport>);
// Or they would need a lock, which is not shared.
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
static_assert(std::atomic<WirePhase>::is_always_lock_free);
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<pid_t>::is_always_lock_free);

}  // namespace sandrunner::unitree
