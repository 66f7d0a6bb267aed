// SPDX-License-Identifier: BSD-3-Clause
// The switch of an emergency stop on a GPIO line.
//
// It is wired as a normally closed one: while it is closed, the line is high; pressed, with a
// broken wire or without its supply, the line is low, held so by the chip's pull-down where it has
// one. Source: Linux, include/uapi/linux/gpio.h, version 2.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>

namespace sandrunner {

struct StopLineConfig {
  std::string chip;  ///< such as /dev/gpiochip0; empty: no switch
  int line = 0;      ///< offset on that chip
};

/// One line of a GPIO chip as an input.
class StopLine {
 public:
  /// Throws InputError: no such chip, no such line, a line in use.
  explicit StopLine(const StopLineConfig& config);
  ~StopLine();
  StopLine(const StopLine&) = delete;
  StopLine& operator=(const StopLine&) = delete;

  /// Whether the line is high; nullopt if the chip does not answer (unplugged). May block as long
  /// as the chip takes, behind I2C or USB more than a control tick.
  std::optional<bool> high() const noexcept;

 private:
  int descriptor_ = -1;
};

/// Reads such a line continuously, in its own thread.
class EmergencyStop {
 public:
  using Read = std::function<std::optional<bool>()>;

  /// `high`: as StopLine::high.
  explicit EmergencyStop(Read high);
  ~EmergencyStop();
  EmergencyStop(const EmergencyStop&) = delete;
  EmergencyStop& operator=(const EmergencyStop&) = delete;

  /// True unless the line was read, and high, within kLongest_ns before `now_ns`
  /// (CLOCK_MONOTONIC), and has not been otherwise since. Wait-free.
  bool pressed(std::int64_t now_ns) const noexcept;

  static constexpr std::int64_t kPeriod_ns = 1'000'000;  ///< pause between two readings
  static constexpr std::int64_t kLongest_ns = 20'000'000;
  static constexpr int kPriority = 75;  ///< that of the IMU's thread

 private:
  void look() noexcept;
  void run() noexcept;

  Read high_;
  std::atomic<std::int64_t>
      closed_ns_;  ///< when the switch was last read as closed; lowest: it is open
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace sandrunner
