// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>
#include <sys/types.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/can/can_socket.h"
#include "rt/run/process_config.h"
#include "tools/hil/bench_report.h"
#include "tools/hil/emulated/emulated_drive.h"
#include "tools/hil/emulated_robot.h"
#include "tools/hil/fault_script.h"
#include "tools/hil/imu_line.h"

namespace sandrunner::hil {

/// The simulated robot at the other end of the controller's CAN buses and serial line, in real time
/// on CLOCK_MONOTONIC: 4000 times a second each drive evaluates its law and the robot moves on; a
/// frame is answered when it comes.
class Bench {
 public:
  /// Opens the buses and makes the IMU's line (ImuLine). `walk_s`: how long the walk will be whose
  /// speed is measured; 0: all of it. Throws InputError.
  Bench(const ProcessConfig& config, const std::string& imu_device, std::vector<TimedFault> faults,
        double walk_s);

  /// Plays as long as `more` says so, which is asked in every 40th tick. `controller`: whom to
  /// kill, 0: nobody. `second`: starts a second controller, if given.
  BenchReport play(const std::function<bool()>& more, pid_t controller = 0,
                   const std::function<void()>& second = {});

 private:
  struct Bus {
    std::string interface;
    std::unique_ptr<CanSocket> socket;
    bool down = false;                   ///< off, or down
    double back_at_s = -1.0;             ///< when it is on again
    std::unique_ptr<CanSocket> foreign;  ///< of another program
  };
  struct Place {
    double x_m, y_m;
  };

  double now_s() const noexcept;
  void exchange(std::int64_t deadline_ns);
  void answer(Bus& bus, int index);
  void make_faults(double now_s);
  void make(const TimedFault& fault, double now_s);
  void send_foreign();
  void turn_on_stand(const JointArray<double>& torque_nm);
  void step(double now_s);
  void observe(double now_s);
  BenchReport report();

  const HardwareConfig hardware_;
  const double walk_kp_, walk_s_;
  std::vector<TimedFault> script_;
  std::vector<Bus> buses_;
  std::vector<pollfd> polled_;  // for ppoll, of buses_
  std::vector<EmulatedDrive> drives_;
  JointArray<double> reboot_end_s_{};
  JointArray<double> hand_rad_{}, hand_target_rad_{};  // by how much hands have turned the joints
  JointArray<double> hand_radps_{};
  bool on_stand_ = false;     // hands work there; nothing else moves
  bool free_joints_ = false;  // but joints under their drives' torque
  JointArray<int> foreign_left_{};
  EmulatedRobot robot_;
  ImuLine imu_;

  pid_t controller_ = 0;
  std::function<void()> second_;
  std::int64_t start_ns_ = 0;
  std::uint64_t tick_ = 0;
  double enabled_at_s_ = -1.0;  ///< all drives together
  std::size_t made_ = 0;        ///< of script_
  std::vector<double> made_at_s_;
  std::vector<Place> walk_;
  Place lay_{};
  std::uint64_t answers_ = 0;
  double answer_sum_us_ = 0.0;
  BenchReport report_;
};

}  // namespace sandrunner::hil
