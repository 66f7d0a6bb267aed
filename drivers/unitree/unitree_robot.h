// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/unitree/unitree_config.h"
#include "drivers/unitree/wire_process.h"
#include "rt/core/robot_io.h"

namespace sandrunner {

/// What SensorFrame says of a motor as drive_fault or drive_warning, as bits. The limits of
/// temperature and battery are those of the warning; kTooHot_degc above, and at half the
/// charge, a motor is a fault.
enum class UnitreeFault : std::uint64_t {
  kMode = 1,     ///< it is not in the mode that it is commanded
  kTooHot = 2,   ///< of hardware.temperature_limit_degc
  kBattery = 4,  ///< the robot's battery has less than hardware.unitree.low_battery_percent
};

/// "too hot, battery low".
std::string unitree_fault_words(std::uint64_t faults);

/// A Unitree robot: the control loop's end of the memory that it shares with the wire's process.
/// Real-time safe: no call waits, and none is a system call but the clock's. Example:
/// unitree_robot_test.cpp.
class UnitreeRobot final : public RobotIo {
 public:
  /// The robot that `wire` has found.
  UnitreeRobot(const UnitreeConfig& config, std::unique_ptr<unitree::WireProcess> wire);

  void read(std::uint64_t tick, SensorFrame& frame) noexcept override;
  void write(const SafeCommand& command) noexcept override;
  /// The wire damps the robot from its next message on, for 2 s, and switches it off.
  void cut_drives() noexcept override;
  void shut_down() noexcept override;

  const unitree::WireProcess& wire() const noexcept { return *wire_; }
  const unitree::WireReport& newest() const noexcept { return newest_; }
  /// All faults and warnings that each motor has had.
  const JointArray<std::uint64_t>& faults() const noexcept { return all_faults_; }
  /// Messages of each motor that the robot's own bus lost during the run.
  std::uint64_t lost(int j) const noexcept { return newest_.state.lost[j] - lost_at_start_[j]; }

 private:
  void take_state(std::uint64_t tick, SensorFrame& frame) noexcept;
  std::uint64_t faults_of(int j) const noexcept;
  std::uint64_t warnings_of(int j) const noexcept;
  /// kTooHot and kBattery, past the limits moved by a margin and by a share.
  std::uint64_t beyond(int j, double margin_degc, double share) const noexcept;

  const UnitreeConfig config_;
  std::unique_ptr<unitree::WireProcess> wire_;
  unitree::WireMemory& memory_;
  unitree::WireReport newest_;
  JointArray<std::uint64_t> lost_at_start_{}, all_faults_{};
  bool started_ = false;
  std::uint64_t tick_ = 0, state_tick_ = 0;
  std::uint64_t enabled_ticks_ = 0;  ///< in a row
  std::uint64_t remote_tick_ = 0;    ///< when it was heard last
};

}  // namespace sandrunner
