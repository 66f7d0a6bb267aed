// SPDX-License-Identifier: BSD-3-Clause
// A robot and a policy on fake time: enough of both to drive the whole control loop.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>

#include "printing.h"
#include "rt/core/controller.h"
#include "rt/core/joint_pd.h"
#include "test_robot.h"

namespace sandrunner {

inline constexpr double kTremble_rad = 1e-6;

/// What no real IMU is without: values that change from sample to sample.
inline void tremble(ImuSample& imu) noexcept {
  const double sign = imu.tick % 2 == 0 ? 1.0 : -1.0;
  imu.orientation_wxyz[3] += sign * kTremble_rad;
  imu.angular_velocity_radps[2] += sign * kTremble_rad;
  imu.linear_acceleration_mps2[2] += sign * kTremble_rad;
}

/// Stands upright whatever its joints do; these follow commanded positions at up to 10 rad/s.
class FakeRobot : public RobotIo {
 public:
  explicit FakeRobot(const JointArray<double>& posture_rad) {
    now.joints.position_rad = posture_rad;
    now.imu.linear_acceleration_mps2 = {0.0, 0.0, kGravity_mps2};
  }

  void read(std::uint64_t, SensorFrame& frame) noexcept override {
    now.joints.tick.fill(now.tick);
    now.imu.tick = now.tick;
    tremble(now.imu);
    frame = now;
  }

  void write(const SafeCommand& command) noexcept override {
    last = command;
    constexpr double kReach_rad = 10.0 * kControlPeriod_s;
    for (int j = 0; j < kNumJoints; ++j) {
      const JointCommand& c = command.joints();
      now.joints.torque_nm[j] =
          joint_torque(now.joints.position_rad[j], now.joints.velocity_radps[j], c.position_rad[j],
                       c.velocity_radps[j], c.kp_nmprad[j], c.kd_nmsprad[j], c.feedforward_nm[j]);
      const bool driven = command.enabled() && c.kp_nmprad[j] > 0.0;
      const double target_rad = driven ? c.position_rad[j] : now.joints.position_rad[j];
      const double way_rad =
          clamp_to(target_rad - now.joints.position_rad[j], -kReach_rad, kReach_rad);
      now.joints.position_rad[j] += way_rad;
      now.joints.velocity_radps[j] = way_rad * kControlHz;
    }
  }

  void cut_drives() noexcept override { now.drives_cut = 1; }
  void shut_down() noexcept override {}

  SensorFrame now;
  SafeCommand last;
};

/// Controller of the test robot, robot and a policy that answers every release at once with
/// `action_rad`, but for one joint that it moves back and forth a little, as a living one does.
class FakeLoop {
 public:
  explicit FakeLoop(Mode start = Mode::kPassive, const ControllerConfig& config_in = test_robot())
      : config(config_in),
        controller(config, start),
        robot(start == Mode::kWalk ? config.stand.nominal_rad : kLyingPosture_rad),
        action_rad(config.stand.nominal_rad) {
    input.command.velocity.vx_mps = 1.0;
  }

  /// One tick. `spoil` may change what the controller is given.
  void tick() {
    robot.read(robot.now.tick, input.sensors);
    input.policy = policy;
    ControllerInput seen = input;
    if (spoil) spoil(seen);
    controller.step(seen, output);
    robot.write(output.command);
    if (output.release_policy != 0 && !policy_hangs) {
      policy.input_tick = output.policy_input.tick;
      policy.episode = output.policy_input.episode;
      ++policy.sequence;
      policy.target_rad = action_rad;
      if (policy.sequence % 2 == 0) policy.target_rad[0] += kTremble_rad;
    }
    ++robot.now.tick;
  }
  void run_s(double duration_s) {
    for (std::uint64_t n = ticks_from_s(duration_s); n > 0; --n) tick();
  }
  void request(ModeRequest wish) {
    if (robot.now.tick == 0) tick();  // the first step only enters the start mode
    input.command.ask(wish);
    tick();
  }
  /// The two steps from Passive to StandUp.
  void stand_up() {
    request(ModeRequest::kArm);
    request(ModeRequest::kStand);
  }
  /// From Passive to `mode`, by requests.
  void reach(Mode mode) {
    if (mode == Mode::kPassive) return;
    if (mode == Mode::kDamping) return request(ModeRequest::kArm);
    stand_up();
    if (mode == Mode::kStandUp) return;
    run_s(3.0);
    if (mode == Mode::kWalk) {
      request(ModeRequest::kWalk);
      run_s(0.1);
    }
  }

  ControllerConfig config;
  Controller controller;
  FakeRobot robot;
  JointArray<double> action_rad;
  bool policy_hangs = false;
  std::function<void(ControllerInput&)> spoil;
  PolicyOutput policy;
  ControllerInput input;
  ControllerOutput output;
};

/// Whether the command can only brake: finite, no stiffness, no feed-forward, no speed asked for.
inline bool only_brakes(const SafeCommand& command) {
  for (int j = 0; j < kNumJoints; ++j) {
    const JointCommand& c = command.joints();
    const double kd = c.kd_nmsprad[j];
    if (c.kp_nmprad[j] != 0.0 || c.feedforward_nm[j] != 0.0 || c.velocity_radps[j] != 0.0 ||
        !std::isfinite(c.position_rad[j]) || !(kd >= 0.0 && kd < 100.0)) {
      return false;
    }
  }
  return true;
}

}  // namespace sandrunner
