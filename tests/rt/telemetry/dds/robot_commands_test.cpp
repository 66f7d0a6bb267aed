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

/// Sends Twists at 50 Hz, however often it is asked to.
class Driver {
 public:
  explicit Driver(Peer& peer)
      : writer_(peer.writer("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc)) {}
  void send(double time_s, double vx_mps) {
    if (time_s < next_s_) return;
    next_s_ = time_s + 0.02;
    drive(writer_, vx_mps);
    ++sent_;
  }
  std::uint64_t sent() const { return sent_; }

 private:
  dds_entity_t writer_;
  double next_s_ = 0.0;
  std::uint64_t sent_ = 0;
};

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
                   RunClock::kRealtime),
        peer_(config_.dds) {}

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
  template <typename Value>
  double mean(double from_s, double to_s, const Value& value) const {
    double sum = 0.0, count = 0.0;
    for (const TickRecord& tick : ticks_) {
      if (at_s(tick) < from_s || at_s(tick) >= to_s) continue;
      sum += value(tick);
      ++count;
    }
    EXPECT_GT(count, 0.0);
    return sum / count;
  }
  /// The robot's true mean speed.
  double speed_mps(double from_s, double to_s) const {
    return mean(from_s, to_s,
                [](const TickRecord& tick) { return tick.truth.state.velocity_mps[0]; });
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
  Peer peer_;
  std::vector<TickRecord> ticks_;
};

TEST_F(RobotCommandsTest, AfterTheLastCommandTheRobotSlowsToAStand) {
  Driver driver(peer_);
  double last_s = 0.0;
  bool came = true;
  walk(4.9, [&](double time_s) {
    if (time_s > 1.8 || !came) return;
    driver.send(time_s, 0.8);
    last_s = time_s;
    // Before the next tick, so that the robot's time tells how old it is.
    came = wait_until([&] { return desk_.counts().accepted == driver.sent(); });
  });
  ASSERT_TRUE(came);
  expect_slows_to_a_stand_after(last_s);
}

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

TEST_F(RobotCommandsTest, InvalidSpeedsAreCountedAndTheRobotFollowsTheLastValidOne) {
  Driver driver(peer_);
  int number = 0;
  walk(2.6, [&](double time_s) {
    const std::uint64_t before = driver.sent();
    const bool rubbish = time_s > 1.0 && time_s < 2.0 && number % 3 != 0;
    driver.send(time_s, !rubbish ? 0.6 : number % 3 == 1 ? kNan : 1e9);
    if (driver.sent() != before) ++number;
  });
  ASSERT_TRUE(wait_until([&] {  // the last ones may be on their way
    const CommandCounts c = desk_.counts();
    return c.accepted + c.not_finite + c.absurd == driver.sent();
  }));
  const CommandCounts counts = desk_.counts();
  EXPECT_GE(counts.not_finite, 8u);  // about 16
  EXPECT_GE(counts.absurd, 8u);
  EXPECT_EQ(counts.other_publisher, 0u);
  const double from_s = first_s(0.0, 0.6);
  EXPECT_LT(from_s, 0.2);
  for (const TickRecord& tick : ticks_) {
    if (at_s(tick) >= from_s) {
      ASSERT_EQ(tick.input.command.velocity.vx_mps, 0.6) << at_s(tick);
    }
  }
  EXPECT_NEAR(speed_mps(0.8, 1.2), 0.6, 0.15);
  EXPECT_NEAR(speed_mps(1.2, 2.6), 0.6, 0.15);
}

TEST_F(RobotCommandsTest, TheSecondPublisherIsRefusedUntilTheFirstIsSilent) {
  Peer other(config_.dds);
  Driver first(peer_), second(other);
  using Steady = std::chrono::steady_clock;
  Steady::time_point last, taken{};
  std::uint64_t first_accepted = 0;
  walk(4.0, [&](double time_s) {
    if (time_s < 1.5) {
      const std::uint64_t before = first.sent();
      first.send(time_s, 0.6);
      if (first.sent() != before) last = Steady::now();
      first_accepted = desk_.counts().accepted;
    } else if (taken == Steady::time_point{} && desk_.counts().accepted > first.sent()) {
      taken = Steady::now();
    }
    if (time_s > 0.3) second.send(time_s, -0.4);
  });
  const double silent_s = std::chrono::duration<double>(taken - last).count();
  EXPECT_GT(silent_s, 0.29);  // the desk saw the last one a little earlier or later
  EXPECT_LT(silent_s, 1.0);
  EXPECT_LE(first_accepted, first.sent());
  const CommandCounts counts = desk_.counts();
  EXPECT_GT(counts.other_publisher, 40u);  // of 75 in 1.5 s
  EXPECT_GT(counts.accepted, first_accepted + 60);
  EXPECT_NEAR(speed_mps(0.9, 1.5), 0.6, 0.15);
  EXPECT_NEAR(speed_mps(3.0, 4.0), -0.4, 0.15);
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
