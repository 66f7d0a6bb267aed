// SPDX-License-Identifier: BSD-3-Clause
// The whole robot in one thread: controller, gate, policy and simulator, with sensors, drives and
// hands that can be changed from outside. Example: drifting_attitude_test.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "rt/core/joint_pd.h"
#include "rt/core/mode_machine.h"
#include "rt/core/rotation.h"
#include "rt/loop/lockstep.h"
#include "tests/rt/support.h"
#include "tests/sim/support.h"

namespace sandrunner::attack {

enum class Drives { kGains, kTorque };

/// Ticks from one sample to the next, and how much each of them is early or late.
struct SampleRates {
  std::uint64_t joint_ticks = 1, imu_ticks = 1;
  std::uint64_t jitter_ticks = 0;
  std::uint64_t attitude_ticks = 1;  ///< the attitude may come in fewer samples than the rest
};

/// The simulated robot behind changed sensors and drives.
class AttackedRobot final : public RobotIo {
 public:
  AttackedRobot(sim::Simulator& simulator, Drives drives)
      : simulator_(simulator), drives_(drives) {}

  void read(std::uint64_t tick, SensorFrame& frame) noexcept override {
    simulator_.read(tick, fresh_);
    if (spoil) spoil(fresh_, tick);
    const SensorFrame& fresh = fresh_;
    const SensorFrame held = seen_;
    seen_ = fresh;
    if (!is_due(tick, rates.joint_ticks, next_joints_tick_)) {
      seen_.joints = held.joints;
      seen_.joints.drive_fault = fresh.joints.drive_fault;
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
    const bool exchange =
        simulator_.state().tick % rates.joint_ticks == 0 || !command.enabled() || !sent_.enabled();
    if (exchange) sent_ = command;
    if (exchange) take_torques();
    simulator_.write(as_driven());
  }
  void skip(std::uint64_t ticks, const SafeCommand& held) noexcept override {
    simulator_.skip(ticks, held);
  }
  void cut_drives() noexcept override { simulator_.cut_drives(); }
  bool truth(RobotTruth& truth) const noexcept override { return simulator_.truth(truth); }
  void shut_down() noexcept override {}

  /// What happens to the values of a tick before they are sampled.
  std::function<void(SensorFrame& fresh, std::uint64_t tick)> spoil;
  SampleRates rates;
  /// Joints whose drive closes its own loop on the spoilt values too, bit j for joint j: the defect
  /// is in the encoder, not on the way from the drive.
  std::uint64_t drive_is_misled = 0;
  std::uint64_t limp = 0;      ///< these drives give no torque, bit j for joint j
  std::uint64_t inverted = 0;  ///< these give it in the wrong direction
  /// Of the torque that each drive gives.
  JointArray<double> torque_scale = all_joints(1.0);

 private:
  bool is_due(std::uint64_t tick, std::uint64_t period, std::uint64_t& next) noexcept {
    if (tick < next) return false;
    const std::uint64_t late =
        rates.jitter_ticks == 0 ? 0 : (tick * 2654435761u >> 7) % (rates.jitter_ticks + 1);
    next = (tick / period + 1) * period + late;
    return true;
  }

  /// What the host computes for torque drives, on what it has read.
  void take_torques() noexcept {
    if (drives_ != Drives::kTorque) return;
    const JointCommand& c = sent_.joints();
    for (int j = 0; j < kNumJoints; ++j) {
      const bool blind = (sent_.blind_joints() >> j & 1) != 0;
      host_nm_[j] = blind
                        ? 0.0
                        : joint_torque(seen_.joints.position_rad[j], seen_.joints.velocity_radps[j],
                                       c.position_rad[j], c.velocity_radps[j], c.kp_nmprad[j],
                                       c.kd_nmsprad[j], c.feedforward_nm[j]);
    }
  }

  SafeCommand as_driven() const noexcept {
    const bool changed = drives_ == Drives::kTorque || drive_is_misled != 0 || limp != 0 ||
                         inverted != 0 || torque_scale != all_joints(1.0) ||
                         sent_.blind_joints() != 0;
    if (!sent_.enabled() || !changed) return sent_;
    const sim::RigidState<double>& x = simulator_.state().robot.rigid;
    JointCommand c = sent_.joints();
    for (int j = 0; j < kNumJoints; ++j) {
      const bool misled = (drive_is_misled >> j & 1) != 0;
      const double position_rad = misled ? fresh_.joints.position_rad[j] : x.q[j];
      const double velocity_radps = misled ? fresh_.joints.velocity_radps[j] : x.qd[j];
      const double wanted_nm =
          drives_ == Drives::kTorque
              ? host_nm_[j]
              : joint_torque(position_rad, velocity_radps, c.position_rad[j], c.velocity_radps[j],
                             c.kp_nmprad[j], c.kd_nmsprad[j], c.feedforward_nm[j]);
      const double sign = (inverted >> j & 1) != 0 ? -1.0 : 1.0;
      c.kp_nmprad[j] = c.kd_nmsprad[j] = 0.0;
      // A drive that answers gives a blind joint no torque in either mode (set_point in
      // can_robot.h).
      const bool no_torque = ((limp | sent_.blind_joints()) >> j & 1) != 0;
      c.feedforward_nm[j] = no_torque ? 0.0 : sign * torque_scale[j] * wanted_nm;
    }
    return sim::pass_gate(c);
  }

  sim::Simulator& simulator_;
  Drives drives_;
  SensorFrame fresh_, seen_;
  SafeCommand sent_;
  JointArray<double> host_nm_{};
  std::uint64_t next_joints_tick_ = 0, next_imu_tick_ = 0, next_attitude_tick_ = 0;
};

/// Angle between the body's and the world's z axis.
inline double tilt_rad(const RobotTruth& truth) {
  return std::acos(std::clamp(body_axes(truth.orientation_wxyz)[2][2], -1.0, 1.0));
}
inline double degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

/// A robot, its policy and the ground that it is on.
struct World {
  explicit World(const std::string& robot, const std::string& terrain,
                 std::vector<std::string> settings = {})
      : policy(load_shipped_policy(robot)) {
    settings.push_back("robot=" + robot);
    config = config_of(terrain, settings, &policy.spec());
  }
  Policy policy;
  ProcessConfig config;
};

struct Snapshot {
  std::uint64_t next_tick;
  sim::SimulatorState robot;
  LockstepState loop;
};

class AttackLoop {
 public:
  /// The robot lies, passive.
  AttackLoop(const World& world, Drives drives)
      : simulator(world.config.robot, world.config.simulator),
        robot(simulator, drives),
        policy_(world.policy),
        loop(robot, world.config.controller, Mode::kPassive, policy_) {
    simulator.reset_lying();
  }
  AttackLoop(const World& world, Drives drives, const Snapshot& at) : AttackLoop(world, drives) {
    simulator.restore(at.robot);
    loop.restore(at.loop, at.next_tick);
    command.request_id = at.loop.controller.request_id;
  }
  AttackLoop(const AttackLoop&) = delete;

  void ask(ModeRequest request) {
    command.request = request;
    ++command.request_id;
  }
  void step() {
    if (hand) {
      sim::SimulatorState state = simulator.state();
      hand(state);
      simulator.restore(state);
    }
    command.tick = loop.next_tick();
    loop.tick(command);
  }
  void run(double duration_s) {
    for (std::uint64_t n = ticks_from_s(duration_s); n > 0; --n) step();
  }
  /// From lying to Stand.
  void stand_up() {
    run(0.1);
    ask(ModeRequest::kArm);
    run(0.1);
    ask(ModeRequest::kStand);
    run(4.0);
  }
  void walk(const VelocityCommand& velocity, double duration_s) {
    command.velocity = velocity;
    ask(ModeRequest::kWalk);
    run(duration_s);
  }
  Snapshot snapshot() { return {loop.next_tick(), simulator.state(), loop.state()}; }

  const RobotTruth& truth() const { return loop.record().truth; }
  const ControllerOutput& output() const { return loop.record().output; }
  Mode mode() const { return output().mode; }
  /// That which holds the latch now.
  Fault fault() const { return output().faults != 0 ? output().first_fault : Fault::kNone; }

  sim::Simulator simulator;
  AttackedRobot robot;
  OperatorCommand command;
  /// Moves the robot before each tick, as a person does who takes hold of it.
  std::function<void(sim::SimulatorState&)> hand;

 private:
  PolicyRunner policy_;

 public:
  Lockstep loop;
};

/// The robot in Stand, or walking at `velocity` for 4 s.
inline Snapshot standing(const World& world, Drives drives) {
  AttackLoop loop(world, drives);
  loop.stand_up();
  EXPECT_EQ(loop.mode(), Mode::kStand);
  return loop.snapshot();
}
inline Snapshot walking(const World& world, Drives drives, const VelocityCommand& velocity,
                        double duration_s = 4.0) {
  AttackLoop loop(world, drives, standing(world, drives));
  loop.walk(velocity, duration_s);
  EXPECT_EQ(loop.mode(), Mode::kWalk);
  return loop.snapshot();
}

}  // namespace sandrunner::attack
