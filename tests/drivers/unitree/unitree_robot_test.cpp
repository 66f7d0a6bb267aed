// SPDX-License-Identifier: BSD-3-Clause
// The control loop's end. The wire's process is there, but does nothing: the test plays it.
#include "drivers/unitree/unitree_robot.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "drivers/unitree/unitree_driver.h"
#include "rt/base/clock_ns.h"
#include "rt/core/safety_gate.h"
#include "tests/rt/core/test_robot.h"
#include "tests/support/joint_names.h"

namespace sandrunner {
namespace {

using unitree::WireReport;

class UnitreeRobotTest : public testing::Test {
 protected:
  UnitreeRobotTest() : wire_(std::make_unique<unitree::WireProcess>(config_, figures())) {
    memory_ = &wire_->memory();
    robot_ = std::make_unique<UnitreeRobot>(config_, std::move(wire_));
    report_.state.battery_percent = 80;
    report_.state.remote.on = true;
    report_.state.mode.fill(0x01);
  }

  static unitree::RobotFigures figures() { return {}; }
  static UnitreeConfig config() {
    UnitreeConfig config;
    config.interface = "lo";
    return config;
  }

  /// The wire hands on a state that is `age_ms` old.
  void deliver(double age_ms = 0.0) {
    ++report_.counters.taken;
    report_.sampled_ns = clock_ns(CLOCK_MONOTONIC) - static_cast<std::int64_t>(1e6 * age_ms);
    memory_->report.write(report_);
  }
  const SensorFrame& read(std::uint64_t tick) {
    frame_.tick = tick;
    robot_->read(tick, frame_);
    return frame_;
  }

  const UnitreeConfig config_ = config();
  std::unique_ptr<unitree::WireProcess> wire_;
  unitree::WireMemory* memory_ = nullptr;
  std::unique_ptr<UnitreeRobot> robot_;
  WireReport report_;
  SensorFrame frame_;
};

TEST_F(UnitreeRobotTest, AStateIsReadOnceWithTheTickOfItsSample) {
  report_.state.position_rad[4] = 0.75;
  report_.state.angular_velocity_radps = {0.5, 0.0, 0.0};
  deliver(3.05);
  read(1000);
  EXPECT_EQ(frame_.joints.position_rad[4], 0.75);
  EXPECT_EQ(frame_.imu.angular_velocity_radps[0], 0.5);
  // 12 ticks, or more where this computer was held up.
  EXPECT_LE(frame_.joints.tick[4], 988);
  EXPECT_EQ(frame_.imu.tick, frame_.joints.tick[4]);
  const std::uint64_t tick = frame_.joints.tick[4];
  read(1001);
  EXPECT_EQ(frame_.joints.tick[4], tick);
}

TEST_F(UnitreeRobotTest, AJointWhoseMessageTheRobotLostKeepsItsValuesAndTick) {
  deliver();
  read(100);
  const std::uint64_t tick = frame_.joints.tick[2];
  report_.state.position_rad.fill(1.0);
  report_.state.lost[2] = 1;
  deliver();
  read(108);
  EXPECT_EQ(frame_.joints.position_rad[2], 0.0);
  EXPECT_EQ(frame_.joints.tick[2], tick);
  EXPECT_EQ(frame_.joints.position_rad[3], 1.0);
  deliver();
  read(116);
  EXPECT_EQ(frame_.joints.position_rad[2], 1.0);
  EXPECT_EQ(robot_->lost(2), 1);
}

TEST_F(UnitreeRobotTest, AHotMotorAndALowBatteryAreWarningsAndLaterDriveFaults) {
  constexpr auto kHot = static_cast<std::uint64_t>(UnitreeFault::kTooHot),
                 kLow = static_cast<std::uint64_t>(UnitreeFault::kBattery);
  std::uint64_t tick = 0;
  const auto expect = [&](int temperature_degc, int battery_percent, std::uint64_t warning,
                          std::uint64_t fault) {
    report_.state.temperature_degc[7] = static_cast<std::int8_t>(temperature_degc);
    report_.state.battery_percent = static_cast<std::uint8_t>(battery_percent);
    deliver();
    const JointState& joints = read(tick += 8).joints;
    EXPECT_EQ(joints.drive_warning[7], warning) << temperature_degc << ", " << battery_percent;
    EXPECT_EQ(joints.drive_fault[7], fault) << temperature_degc << ", " << battery_percent;
    EXPECT_EQ(joints.drive_fault[6], fault & kLow);
  };
  expect(80, 10, 0, 0);
  expect(81, 10, kHot, 0);
  expect(90, 5, kHot | kLow, 0);
  expect(91, 10, kHot, kHot);
  expect(80, 4, kLow, kLow);
  EXPECT_EQ(unitree_fault_words(robot_->faults()[7]), "too hot, battery low");
}

SafeCommand damping() {
  const ControllerConfig robot = test_robot();
  const SafetyGate gate(robot.gate, {2.0, 2.0, 2.0});
  GateState state;
  JointCommand command;
  command.kd_nmsprad.fill(2.0);
  return gate.pass(command, true, {}, state);
}

TEST_F(UnitreeRobotTest, AMotorInAnotherModeIsAFaultOnceItHadTimeToFollow) {
  report_.state.mode[5] = 0;
  deliver();
  for (std::uint64_t tick = 1; tick <= 400; ++tick) {
    ASSERT_EQ(read(tick).joints.drive_fault[5], 0) << tick;
    robot_->write(damping());
  }
  robot_->write(damping());
  EXPECT_EQ(read(402).joints.drive_fault[5], static_cast<std::uint64_t>(UnitreeFault::kMode));
  robot_->write(SafeCommand());  // off: any mode will do
  EXPECT_EQ(read(403).joints.drive_fault[5], 0);
}

TEST_F(UnitreeRobotTest, TheRemotesStopIsAnEmergencyStop) {
  deliver();
  EXPECT_EQ(read(8).emergency_stop, 0);
  report_.state.remote.stop = true;
  deliver();
  EXPECT_EQ(read(16).emergency_stop, 1);
}

TEST_F(UnitreeRobotTest, ALostRemoteIsAnEmergencyStopAfterAFifthOfASecond) {
  deliver();
  read(8);
  report_.state.remote.on = false;
  deliver();
  EXPECT_EQ(read(16).emergency_stop, 0);
  deliver();
  EXPECT_EQ(read(808).emergency_stop, 0);
  EXPECT_EQ(read(809).emergency_stop, 1);
}

TEST_F(UnitreeRobotTest, AnotherProgramIsForeignTrafficOfAllJoints) {
  deliver();
  EXPECT_EQ(read(8).foreign_traffic, 0);
  memory_->foreign = true;
  memory_->gave_up = true;
  EXPECT_EQ(read(9).foreign_traffic, 0xFFF);
  EXPECT_EQ(frame_.drives_cut, 0);
}

TEST_F(UnitreeRobotTest, CutDrivesAndAWireThatGaveUpAreDrivesCut) {
  deliver();
  EXPECT_EQ(read(8).drives_cut, 0);
  memory_->gave_up = true;
  EXPECT_EQ(read(9).drives_cut, 1);
  memory_->gave_up = false;
  robot_->cut_drives();
  EXPECT_TRUE(memory_->cut);
  EXPECT_EQ(read(10).drives_cut, 1);
}

TEST_F(UnitreeRobotTest, ACommandReachesTheWire) {
  deliver();
  read(8);
  robot_->write(SafeCommand());
  EXPECT_EQ(memory_->command.read().enabled, 0);
  robot_->write(damping());
  const unitree::WireCommand& command = memory_->command.read();
  EXPECT_EQ(command.enabled, 1);
  EXPECT_EQ(command.joints.kd_nmsprad[11], 2.0);
  EXPECT_LE(command.written_ns, clock_ns(CLOCK_MONOTONIC));
  EXPECT_EQ(memory_->command.sequence(), 2);
}

TEST(UnitreeDriverTest, DryRunSaysWhatWouldBeSent) {
  UnitreeConfig config;
  config.interface = "eth0";
  RobotDescription robot;
  for (int j = 0; j < kNumJoints; ++j) robot.joint_names[j] = kJointNames[j];
  ControllerConfig controller;
  controller.damping.kd_nmsprad.fill(2.0);
  UnitreeDriver driver(config, robot);
  driver.fit_to(controller);
  StandConfig stand;
  for (int j = 0; j < kNumJoints; ++j) {
    stand.nominal_rad[j] = std::array{0.0, 0.9, -1.8}[static_cast<std::size_t>(j % 3)];
  }
  stand.kp_nmprad = 20.0;
  stand.kd_nmsprad = 0.5;
  const std::string text = driver.dry_run(stand);
  for (const char* line : {"off: all motors in mode 0, CRC 322AC991\n",
                           "damping: mode 1, kd 2.000, 2.000, 2.000, CRC 2E5B6080\n",
                           "stand: mode 1, kp 20.000, kd 0.500, CRC 190C4FD7\n",
                           "  motor_cmd[ 5]  LF_KFE         q  -1.8000\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << "in\n" << text;
  }
}

}  // namespace
}  // namespace sandrunner
