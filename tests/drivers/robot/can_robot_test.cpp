// SPDX-License-Identifier: BSD-3-Clause
// What of the robot needs no bus. With buses it runs on the bench (tools/hil).
#include "drivers/robot/can_robot.h"

#include <gtest/gtest.h>

#include "rt/core/safety_gate.h"

namespace sandrunner {
namespace {

TEST(CanRobotTest, AStepOfTheWallClockMakesNoFrameOlderThanTheTimeSinceThereWasNone) {
  constexpr std::int64_t kHour_ns = 3'600'000'000'000, kLongest_ns = 250'000;
  EXPECT_EQ(frame_age_ns(1'000'000, 1'100'000, kLongest_ns), 100'000);
  EXPECT_EQ(frame_age_ns(1'000'000, 1'100'000 + kHour_ns, kLongest_ns), kLongest_ns);
  EXPECT_EQ(frame_age_ns(1'000'000, 1'100'000 - kHour_ns, kLongest_ns), 0);
}

/// What goes out, and whether the drives are cut while it does: of the first bus, the second.
std::vector<std::uint32_t> sent_to_two_buses(bool cut_before, bool cut_between, bool cut_within) {
  std::atomic<bool> cut{cut_before};
  std::array<CanFrame, 1> set_point, off;
  set_point[0].id = 1;
  off[0].id = 2;
  std::vector<std::uint32_t> ids;
  for (int bus = 0; bus < 2; ++bus) {
    send_unless_cut(cut, set_point, off, [&](std::span<const CanFrame> frames) {
      if (cut_within && bus == 1) cut = true;
      ids.push_back(frames[0].id);
    });
    if (cut_between) cut = true;
  }
  return ids;
}

TEST(CanRobotTest, AfterACutNoSetPointIsTheLastThatADriveHears) {
  using Ids = std::vector<std::uint32_t>;
  EXPECT_EQ(sent_to_two_buses(false, false, false), (Ids{1, 1}));
  EXPECT_EQ(sent_to_two_buses(true, false, false), (Ids{2, 2}));
  EXPECT_EQ(sent_to_two_buses(false, true, false), (Ids{1, 2}));
  EXPECT_EQ(sent_to_two_buses(false, false, true), (Ids{1, 1, 2}));
}

/// What the gate sends after joint 4's encoder has jumped.
SafeCommand after_encoder_jump() {
  GateConfig config;
  config.joint_lower_rad.fill(-3.0);
  config.joint_upper_rad.fill(3.0);
  config.torque_limit_nm.fill(50.0);
  config.continuous_torque_nm.fill(50.0);
  config.speed_fault_radps.fill(50.0);
  const SafetyGate gate(config, {2.0, 2.0, 2.0});
  GateState state;
  SensorFrame sensors;
  VelocityCommand command;
  for (int n = 0; n < 2; ++n) {
    sensors.joints.tick.fill(sensors.tick);
    sensors.imu.tick = sensors.tick;
    gate.judge({.sensors = sensors, .command = command, .policy_input_tick = 0}, Mode::kDamping,
               state);
    sensors.joints.position_rad[4] += 1.0;
    ++sensors.tick;
  }
  EXPECT_EQ(state.first_fault, Fault::kEncoderJump);
  return gate.pass({}, true, sensors.joints, state);
}

TEST(CanRobotTest, ABlindJointGetsNoTorqueButByItsOwnDriveIfThatIsSilent) {
  const SafeCommand command = after_encoder_jump();
  const Drive drive{};
  const auto kd = [&](int j, bool answers) {
    return set_point(command, j, drive, DriveMode::kGains, answers).kd_nmsprad;
  };
  EXPECT_EQ(kd(3, true), 2.0);
  EXPECT_EQ(kd(4, true), 0.0);
  EXPECT_EQ(kd(4, false), 2.0);
}

}  // namespace
}  // namespace sandrunner
