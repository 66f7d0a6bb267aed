// SPDX-License-Identifier: BSD-3-Clause
// The simulated robot walks on sand in real time, commanded over DDS.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "rt/loop/lockstep.h"
#include "rt/run/dds_bridge.h"
#include "sim/simulator.h"
#include "tests/rt/support.h"
#include "tests/rt/telemetry/dds/support.h"
#include "tests/support/child_process.h"
#include "tests/support/not_finite.h"
#include "tests/support/small_robot.h"

namespace sandrunner {
namespace {

class RobotCommandsTest : public testing::Test {
 protected:
  RobotCommandsTest()
      : policy_(load_shipped_policy()),
        config_(config_of(
            "dry-sand", {"dds.enabled=true", "dds.domain=" + std::to_string(test_config().domain)},
            policy_.spec())),
        participant_(config_.dds),
        op_(config_.dds.stale_ticks()),
        desk_(op_, config_.dds.stale_s, nullptr),
        inbox_(participant_, config_.dds, "raibo@here", desk_),
        telemetry_(participant_, config_.dds, config_.robot.description, &desk_,
                   RunClock::kRealtime) {}

  /// Walks for this long, in lockstep but not ahead of time; `at` is called after each tick.
  void walk(double duration_s, const std::function<void(double time_s)>& at) {
    sim::Simulator simulator(config_.robot, config_.simulator);
    Lockstep loop(simulator, config_.controller, Mode::kWalk, policy_);
    const auto start = std::chrono::steady_clock::now();
    for (double time_s = 0.0; time_s < duration_s; time_s += kControlPeriod_s) {
      std::this_thread::sleep_until(start + std::chrono::duration<double>(time_s));
      loop.tick(op_, false);
      telemetry_.add(loop.record());
      ticks_.push_back(loop.record());
      at(time_s);
    }
    for (const TickRecord& tick : ticks_) {
      const auto& q = tick.input.sensors.imu.orientation_wxyz;
      const double up = 1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]);
      ASSERT_GT(up, 0.9) << "at " << at_s(tick) << " s";  // 26 degrees
      ASSERT_EQ(tick.output.mode, Mode::kWalk);
    }
  }

  static double at_s(const TickRecord& tick) {
    return static_cast<double>(tick.input.sensors.tick) * kControlPeriod_s;
  }
  /// The robot's true mean speed.
  double speed_mps(double from_s, double to_s) const {
    double sum = 0.0, count = 0.0;
    for (const TickRecord& tick : ticks_) {
      if (at_s(tick) < from_s || at_s(tick) >= to_s) continue;
      sum += tick.truth.state.velocity_mps[0];
      ++count;
    }
    EXPECT_GT(count, 0.0);
    return sum / count;
  }
  /// The first time from `from_s` on at which the controller was given this velocity.
  double first_s(double from_s, double vx_mps) const {
    for (const TickRecord& tick : ticks_) {
      if (at_s(tick) >= from_s && tick.input.command.velocity.vx_mps == vx_mps) return at_s(tick);
    }
    return kNan;
  }
  /// The last command came at `silent_s`.
  void expect_slows_to_a_stand_after(double silent_s) const {
    EXPECT_GT(speed_mps(silent_s - 0.5, silent_s), 0.3);
    EXPECT_NEAR(first_s(silent_s, 0.0) - silent_s, 0.3, 0.1);
    EXPECT_LT(std::fabs(speed_mps(silent_s + 2.5, silent_s + 3.0)), 0.05);
  }

  PolicyRunner policy_;
  const ProcessConfig config_;
  DdsParticipant participant_;
  RemoteOperator op_;
  OperatorDesk desk_;
  CommandInbox inbox_;
  Telemetry telemetry_;
  std::vector<TickRecord> ticks_;
};

TEST_F(RobotCommandsTest, APublisherThatIsKilledLeavesAStandingRobot) {
  std::unique_ptr<ChildProcess> driver = std::make_unique<ChildProcess>(std::vector<std::string>{
      SANDRUNNER_DDS_PEER, std::to_string(config_.dds.domain), "lo", "drive", "0.8", "10000"});
  double killed_s = 0.0;
  walk(8.4, [&](double time_s) {
    if (killed_s > 0.0 || desk_.counts().accepted < 75) return;
    driver->signal(SIGKILL);
    killed_s = time_s;
  });
  ASSERT_GT(killed_s, 0.0);
  ASSERT_LT(killed_s, 5.4);
  expect_slows_to_a_stand_after(killed_s);
}

TEST(DdsBridgeTest, ARobotOfAnotherFileIsPublishedUnderItsOwnNames) {
  const TemporaryFolder folder;
  const ProcessConfig config = config_of(
      "rigid",
      {"robot=" + write_small_robot(folder), "dds.domain=" + std::to_string(test_config().domain)});
  DdsBridge bridge(config, nullptr, RunClock::kRealtime);
  Peer peer(config.dds);
  const auto descriptions =
      peer.reader("rt/robot_description", std_msgs_msg_dds__String__desc, true);
  const auto joints = peer.reader("rt/joint_states", sensor_msgs_msg_dds__JointState__desc);
  const auto transforms = peer.reader("rt/tf", tf2_msgs_msg_dds__TFMessage__desc);
  for (std::uint64_t tick = 0; tick <= kTicksPerPolicyStep; ++tick) bridge.add(example_tick(tick));
  EXPECT_EQ(take<std_msgs_msg_dds__String_>(
                descriptions,
                [&](const auto& m) { EXPECT_EQ(m.data, config.robot.description.ros_urdf); }),
            1);
  EXPECT_EQ(take<sensor_msgs_msg_dds__JointState_>(joints,
                                                   [&](const auto& m) {
                                                     EXPECT_STREQ(m.header.frame_id, "base_link");
                                                     EXPECT_STREQ(m.name._buffer[0], "fl_roll");
                                                     EXPECT_STREQ(m.name._buffer[11], "rr_knee");
                                                   }),
            1);
  EXPECT_EQ(take<tf2_msgs_msg_dds__TFMessage_>(
                transforms,
                [&](const auto& m) {
                  ASSERT_EQ(m.transforms._length, 1u + kNumJoints);
                  EXPECT_STREQ(m.transforms._buffer[0].child_frame_id, "base_link");
                  EXPECT_STREQ(m.transforms._buffer[1].child_frame_id, "fl_hip");
                }),
            1);
}

}  // namespace
}  // namespace sandrunner
