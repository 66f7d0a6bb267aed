// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/can/can_socket.h"
#include "drivers/robot/hardware_config.h"
#include "tools/hil/emulated/emulated_drive.h"
#include "tools/hil/imu_line.h"
#include "tools/hil/link.h"

namespace sandrunner::hil {

/// Twelve drives on CAN buses, and an IMU on a serial line. 4000 times a second each drive
/// evaluates its law; a frame is answered when it comes.
class CanLink final : public Link {
 public:
  /// Opens the buses and makes the IMU's line (ImuLine). Throws InputError.
  CanLink(const HardwareConfig& hardware, const RobotDescription& description,
          const sim::Simulator& robot, const std::string& imu_device,
          std::span<const TimedFault> script);
  /// Sets interfaces up again, and takes away queues.
  ~CanLink() override;

  static std::span<const LinkFault<CanLink>> faults();

  std::string greeting() const override;
  std::int64_t cycle_ns() const noexcept override { return kControlPeriod_ns; }
  double exchange(std::int64_t end_ns) override;
  bool make(const TimedFault& fault, double now_s) override;
  const JointArray<DriveMoment>& step(double now_s, sim::Simulator& robot) override;
  LinkFigures figures(bool was_enabled) const override;

 private:
  struct Bus {
    std::string interface;
    std::unique_ptr<CanSocket> socket;
    bool down = false;                   ///< off, or down
    double back_at_s = -1.0;             ///< when it is on again
    std::unique_ptr<CanSocket> foreign;  ///< of another program
    bool has_queue = false;
  };

  void answer(Bus& bus, int index);
  DriveFaults& faults(const TimedFault& fault) { return drives_[fault.first].faults(); }
  void reboot(const TimedFault& fault);
  void bus_off(Bus& bus);
  void set_down(const TimedFault& fault, bool down);
  void die();
  void end_faults(double now_s);
  void send_foreign();
  void turn_on_stand(const sim::Simulator& robot);

  const HardwareConfig hardware_;
  const RobotDescription description_;
  std::vector<Bus> buses_;
  std::vector<pollfd> polled_;  // for ppoll, of buses_
  std::vector<EmulatedDrive> drives_;
  JointArray<DriveMoment> moments_;
  ImuLine imu_;
  std::uint64_t tick_ = 0;

  JointArray<double> reboot_end_s_{};
  JointArray<double> hand_rad_{}, hand_target_rad_{};  // by how much hands have turned the joints
  JointArray<double> hand_radps_{};
  bool on_stand_ = false;     // hands work there; nothing else moves
  bool free_joints_ = false;  // but joints under their drives' torque
  JointArray<int> foreign_left_{};

  std::uint64_t answers_ = 0;
  double answer_sum_us_ = 0.0, answer_longest_us_ = 0.0;  // from the kernel's receipt to sent
};

}  // namespace sandrunner::hil
