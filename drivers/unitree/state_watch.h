// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "drivers/imu/device_clock.h"
#include "drivers/unitree/messages.h"

namespace sandrunner::unitree {

/// What became of the states that a robot sent.
struct StateCounters {
  std::uint64_t taken = 0;
  std::uint64_t without_crc = 0;  ///< of those taken
  std::uint64_t bad_crc = 0, not_finite = 0;
  std::uint64_t repeated = 0;  ///< the robot's clock stood still
  std::uint64_t old = 0;       ///< it went back

  std::uint64_t received() const noexcept { return taken + bad_crc + not_finite + repeated + old; }
};

/// Which of the states that arrive are new ones, and when each was sampled. A state whose CRC is
/// wrong, that has a number which is not finite, or whose clock did not advance is none.
class StateWatch {
 public:
  explicit StateWatch(int tick_hz) noexcept : tick_ns_(1'000'000'000 / tick_hz) {}

  /// A message was received at `now_ns`, CLOCK_MONOTONIC. True: it is a new state.
  bool take(const LowState& message, std::int64_t now_ns) noexcept;

  const RobotState& state() const noexcept { return state_; }
  /// When it was sampled, on this computer's clock.
  std::int64_t sampled_ns() const noexcept { return sampled_ns_; }
  const StateCounters& counters() const noexcept { return counters_; }

  // Of the states that were taken, since begin_figures():
  void begin_figures() noexcept;
  double rate_hz() const noexcept;
  double longest_gap_s() const noexcept { return 1e-9 * static_cast<double>(longest_gap_ns_); }
  /// How fast the robot's clock runs, ticks of it in a second of this computer's.
  double tick_rate_hz() const noexcept;

 private:
  std::int64_t tick_ns_;
  RobotState state_;
  DeviceClock clock_;
  StateCounters counters_;
  std::uint64_t device_ns_ = 0;
  std::int64_t sampled_ns_ = 0, received_ns_ = 0;

  std::int64_t first_ns_ = 0, longest_gap_ns_ = 0;
  std::uint32_t first_tick_ = 0;
  std::uint64_t counted_ = 0;
};

}  // namespace sandrunner::unitree
