// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "drivers/can/can_error.h"
#include "drivers/can/can_socket.h"
#include "drivers/imu/imu_thread.h"
#include "drivers/robot/can_guard.h"
#include "drivers/robot/drive.h"
#include "drivers/robot/drive_look.h"
#include "drivers/robot/emergency_stop.h"
#include "drivers/robot/hardware_config.h"
#include "rt/core/robot_io.h"

namespace sandrunner {

/// Counters of a bus since it was opened.
struct BusCounters {
  std::uint64_t sent = 0, received = 0;
  std::uint64_t not_sent = 0;          ///< frames that it rejected ...
  CanStatus refusal = CanStatus::kOk;  ///< ... and the latest reason
  std::uint64_t foreign = 0;           ///< frames that are no reply of this robot's drives
  std::uint64_t overflowed = 0;        ///< frames that the kernel dropped
  std::uint64_t bus_off = 0;           ///< times
  std::uint64_t errors = 0;            ///< other error frames
};

/// Sends the `set_points` of one bus and, if `cut` was set until then, its `off` frames after them:
/// the thread that sets it may have sent its own before these set-points. `send` takes a span.
template <typename Send>
void send_unless_cut(const std::atomic<bool>& cut, std::span<const CanFrame> set_points,
                     std::span<const CanFrame> off, const Send& send) noexcept {
  if (!cut.load()) send(set_points);
  if (cut.load()) send(off);
}

/// The age of a frame that the kernel stamped at `stamp_ns`, by a clock that may be stepped: at
/// most `longest_ns`, the time since no frame was there.
constexpr std::int64_t frame_age_ns(std::int64_t stamp_ns, std::int64_t now_ns,
                                    std::int64_t longest_ns) noexcept {
  return std::clamp<std::int64_t>(now_ns - stamp_ns, 0, longest_ns);
}

/// A robot of drives on CAN buses and an IMU on a serial line.
///
/// Every `ticks_per_exchange` ticks, write() sends each drive its command, and each answers with
/// its state, which the next read() that finds it takes: an exchange costs the loop no waiting.
/// Values have the tick in which the kernel received them. While the robot is off, each drive gets
/// an off frame in every exchange and answers it. Real-time safe once constructed. Example:
/// can_robot_test.cpp.
class CanRobot final : public RobotIo {
 public:
  /// Opens buses and IMU, listens for other programs, finds every drive, and compares the settings
  /// that drives can report with the configuration; nothing is enabled.
  /// Some seconds at most. Throws InputError, one line: a drive that does not answer, other limits
  /// than configured, a missing time-out, an impossible posture, an overloaded bus. `guard`: null
  /// where every drive's own time-out is verified.
  CanRobot(const HardwareConfig& config, const RobotDescription& robot, const GateConfig& gate,
           std::unique_ptr<CanGuard> guard = nullptr);
  ~CanRobot() override;

  void read(std::uint64_t tick, SensorFrame& frame) noexcept override;
  void write(const SafeCommand& command) noexcept override;
  void cut_drives() noexcept override;
  void shut_down() noexcept override;

  const std::vector<BusCounters>& bus_counters() const noexcept { return counters_; }
  const JointArray<Drive>& drives() const noexcept { return drives_; }
  const ImuThread& imu() const noexcept { return imu_; }

 private:
  /// Sends off frames to all drives until each has answered, for 0.1 s at most.
  void switch_off() noexcept;
  void receive(std::uint64_t tick) noexcept;
  void take(int bus, const ReceivedFrame& received, std::uint64_t tick, std::int64_t now_ns,
            std::int64_t longest_ns) noexcept;
  void exchange(const SafeCommand* command) noexcept;
  void send(int bus, std::span<const CanFrame> frames) noexcept;

  HardwareConfig config_;
  std::unique_ptr<CanGuard> guard_;
  std::unique_ptr<EmergencyStop> emergency_stop_;  // null: there is none
  CanSockets sockets_;  // before the IMU: another program that runs the drives is reported first
  ImuThread imu_;
  std::vector<BusCounters> counters_;
  JointArray<Drive> drives_;
  OffFrames off_frames_;  ///< for cut_drives()
  std::uint64_t tick_ = 0, next_exchange_ = 0;
  std::int64_t emptied_ns_ = 0;  ///< when nothing more was to be received, CLOCK_MONOTONIC
  bool enabled_ = false;
  std::atomic<bool> cut_{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
};

/// The command to the drive of joint `j`: in kGains the joint's command as it is, in kTorque its
/// torque at the newest values of `drive`. A blind joint gets no torque. A silent drive in kGains
/// (`answers` is false) continues with its own encoder: it may still receive.
SetPoint set_point(const SafeCommand& command, int j, const Drive& drive, DriveMode mode,
                   bool answers) noexcept;

/// The counters of buses, drives and IMU as text.
std::string hardware_report(const CanRobot& robot, const HardwareConfig& config,
                            const RobotDescription& description);

}  // namespace sandrunner
