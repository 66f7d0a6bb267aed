// SPDX-License-Identifier: BSD-3-Clause
// The simulated robot behind sensors and drives that can be wrong, silent, slow or limp.
#pragma once

#include <cstdint>
#include <functional>

#include "rt/core/joint_pd.h"
#include "rt/core/robot_io.h"
#include "sim/simulator.h"
#include "tests/rt/support.h"
#include "tests/sim/support.h"

namespace sandrunner {

enum class Drives { kGains, kTorque };

/// Ticks from one sample to the next, and how much each of them is early or late.
struct SampleRates {
  std::uint64_t joint_ticks = 1, imu_ticks = 1;
  std::uint64_t jitter_ticks = 0;
  std::uint64_t attitude_ticks = 1;  ///< the attitude may come in fewer samples than the rest
};

/// The simulated robot behind sensors and drives that can be changed.
class FaultyRobot final : public RobotIo {
 public:
  FaultyRobot(sim::Simulator& simulator, Drives drives) : simulator_(simulator), drives_(drives) {}

  void read(std::uint64_t tick, SensorFrame& frame) noexcept override {
    simulator_.read(tick, fresh_);
    if (spoil) {
      spoil(fresh_, good_, since_++);
    } else {
      good_ = fresh_;
    }
    const SensorFrame held = seen_;
    seen_ = fresh_;
    if (!is_due(tick, rates.joint_ticks, next_joints_tick_)) {
      seen_.joints = held.joints;
      seen_.joints.drive_fault = fresh_.joints.drive_fault;
    }
    if (!is_due(tick, rates.imu_ticks, next_imu_tick_)) {
      seen_.imu = held.imu;
    } else if (tick < next_attitude_tick_) {
      seen_.imu.orientation_wxyz = held.imu.orientation_wxyz;
    } else {
      next_attitude_tick_ = (tick / rates.attitude_ticks + 1) * rates.attitude_ticks;
    }
    frame = seen_;
  }
  void write(const SafeCommand& command) noexcept override {
    last = command;
    if (simulator_.state().tick % rates.joint_ticks == 0 || !command.enabled() ||
        !sent_.enabled()) {
      sent_ = command;
      take_torques();
    }
    simulator_.write(as_driven());
  }
  void skip(std::uint64_t ticks, const SafeCommand& held) noexcept override {
    sent_ = held;
    take_torques();
    simulator_.skip(ticks, as_driven());
  }
  void cut_drives() noexcept override { simulator_.cut_drives(); }
  bool truth(RobotTruth& truth) const noexcept override {
    return has_truth && simulator_.truth(truth);
  }
  void shut_down() noexcept override {}

  /// What happens to the values of each tick before they are sampled; `good` are the last ones
  /// before, `n` counts from 0.
  std::function<void(SensorFrame& fresh, const SensorFrame& good, std::uint64_t n)> spoil;
  SampleRates rates;
  bool has_truth = true;  ///< a real robot has none
  SafeCommand last;
  /// Joints whose drive closes its own loop on the spoilt values too, bit j for joint j: the defect
  /// is in the encoder, not on the way from the drive.
  std::uint64_t drive_is_misled = 0;
  std::uint64_t limp = 0;      ///< these drives give no torque, bit j for joint j
  std::uint64_t inverted = 0;  ///< these give it in the wrong direction

 private:
  bool is_due(std::uint64_t tick, std::uint64_t period, std::uint64_t& next) noexcept {
    if (tick < next) return false;
    const std::uint64_t late =
        rates.jitter_ticks == 0 ? 0 : (tick * 2654435761u >> 7) % (rates.jitter_ticks + 1);
    next = (tick / period + 1) * period + late;
    return true;
  }

  static double torque(const JointCommand& c, int j, double position_rad,
                       double velocity_radps) noexcept {
    return joint_torque(position_rad, velocity_radps, c.position_rad[j], c.velocity_radps[j],
                        c.kp_nmprad[j], c.kd_nmsprad[j], c.feedforward_nm[j]);
  }

  // What the host computes for torque drives, on what it has read.
  void take_torques() noexcept {
    for (int j = 0; j < kNumJoints; ++j) {
      host_nm_[j] =
          torque(sent_.joints(), j, seen_.joints.position_rad[j], seen_.joints.velocity_radps[j]);
    }
  }

  // What reaches the drives. One that answers gives a blind joint no torque in either mode
  // (set_point in can_robot.h).
  SafeCommand as_driven() const noexcept {
    if (!sent_.enabled()) return sent_;
    const sim::RigidState<double>& x = simulator_.state().robot.rigid;
    JointCommand c = sent_.joints();
    bool changed = false;
    for (int j = 0; j < kNumJoints; ++j) {
      const auto is_in = [j](std::uint64_t joints) { return (joints >> j & 1) != 0; };
      const bool no_torque = is_in(limp | sent_.blind_joints());
      if (drives_ == Drives::kGains && !is_in(drive_is_misled | inverted) && !no_torque) continue;
      changed = true;
      const bool misled = is_in(drive_is_misled);
      const double wanted_nm = drives_ == Drives::kTorque
                                   ? host_nm_[j]
                                   : torque(c, j, misled ? fresh_.joints.position_rad[j] : x.q[j],
                                            misled ? fresh_.joints.velocity_radps[j] : x.qd[j]);
      c.kp_nmprad[j] = c.kd_nmsprad[j] = 0.0;
      const double sign = is_in(inverted) ? -1.0 : 1.0;
      c.feedforward_nm[j] = no_torque ? 0.0 : sign * wanted_nm;
    }
    return changed ? sim::pass_gate(c) : sent_;
  }

  sim::Simulator& simulator_;
  Drives drives_;
  SensorFrame fresh_, good_, seen_;
  std::uint64_t since_ = 0;
  SafeCommand sent_;
  JointArray<double> host_nm_{};
  std::uint64_t next_joints_tick_ = 0, next_imu_tick_ = 0, next_attitude_tick_ = 0;
};

}  // namespace sandrunner
