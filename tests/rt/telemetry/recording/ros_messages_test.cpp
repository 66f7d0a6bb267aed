// SPDX-License-Identifier: BSD-3-Clause
// ROS 2's topics in the recording of a robot with names of its own.
#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "rt/telemetry/mcap/mcap_reader.h"
#include "rt/telemetry/recording/cdr.h"
#include "rt/telemetry/recording/recording_writer.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

class RosMessagesTest : public testing::Test {
 protected:
  /// Keeps the last message of each topic of a recording of half a second.
  void SetUp() override {
    const std::string path = folder_.path("run.mcap");
    RecordingInfo info;
    info.robot = robot_;
    info.start_time_ns = kExampleStart_ns;
    RecordingWriter writer(path, info);
    for (std::uint64_t tick = 0; tick <= 2000; ++tick) writer.write(std::array{example_tick(tick)});
    writer.close();
    McapReader reader(path);
    while (const McapMessage* message = reader.next()) {
      messages_[reader.channels().at(message->channel_id).topic] = {message->data.begin(),
                                                                    message->data.end()};
    }
  }

  /// What follows the header of a message, which is expected to have this frame.
  CdrReader after_header(CdrReader cdr, const std::string& frame) {
    EXPECT_EQ(cdr.number<std::int32_t>(), 1'700'000'001);  // 0.5 s after the start
    EXPECT_EQ(cdr.number<std::uint32_t>(), 400'000'000u);
    EXPECT_EQ(text(cdr), frame);
    return cdr;
  }
  static std::string text(CdrReader& cdr) {
    const auto size = cdr.number<std::uint32_t>();
    const auto bytes = cdr.block(size, 1);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.empty() ? 0 : bytes.size() - 1};
  }
  static void expect(CdrReader& cdr, std::initializer_list<double> values) {
    for (const double value : values) EXPECT_EQ(cdr.number<double>(), value);
  }
  static void expect_zeros(CdrReader& cdr, int count) {
    for (int i = 0; i < count; ++i) EXPECT_EQ(cdr.number<double>(), 0.0);
  }
  static void expect_end(const CdrReader& cdr) {
    EXPECT_FALSE(cdr.failed());
    EXPECT_EQ(cdr.left(), 0u);
  }

  const TemporaryFolder folder_;
  const RobotDescription robot_ = example_robot();
  std::map<std::string, std::vector<std::byte>> messages_;
};

TEST_F(RosMessagesTest, JointStatesHaveTheRobotsNamesAndWhatWasMeasured) {
  CdrReader cdr = after_header(CdrReader(messages_["/joint_states"]), "base_link");
  EXPECT_EQ(cdr.number<std::uint32_t>(), 12u);
  for (const std::string& name : robot_.joint_names) EXPECT_EQ(text(cdr), name);
  const JointState joints = example_tick(2000).input.sensors.joints;
  for (const auto& values : {joints.position_rad, joints.velocity_radps, joints.torque_nm}) {
    EXPECT_EQ(cdr.number<std::uint32_t>(), 12u);
    for (const double value : values) EXPECT_EQ(cdr.number<double>(), value);
  }
  expect_end(cdr);
}

TEST_F(RosMessagesTest, ImuIsWhatTheSensorSaidInTheRobotsBaseLink) {
  CdrReader cdr = after_header(CdrReader(messages_["/imu/data"]), "base_link");
  expect(cdr, {0.0, 0.0, 0.70710678118654752, 0.70710678118654752});  // x, y, z, w
  expect_zeros(cdr, 9);
  expect(cdr, {0.1, 0.2, 0.3});
  expect_zeros(cdr, 9);
  expect(cdr, {0.4, 0.5, 9.8});
  expect_zeros(cdr, 9);
  expect_end(cdr);
}

TEST_F(RosMessagesTest, OdometryAndTransformLeadToTheRobotsBaseLink) {
  CdrReader tf(messages_["/tf"]);
  EXPECT_EQ(tf.number<std::uint32_t>(), 3u);  // and the two links that a joint turns
  CdrReader odometry(messages_["/odom"]);
  for (CdrReader* cdr : {&tf, &odometry}) {
    *cdr = after_header(*cdr, "odom");
    EXPECT_EQ(text(*cdr), "base_link");
    EXPECT_NEAR(cdr->number<double>(), 0.0, 1e-9);
    EXPECT_NEAR(cdr->number<double>(), 0.4, 1e-9);  // 0.8 m/s to its front, which is the left
    expect(*cdr, {0.45, 0.0, 0.0, 0.70710678118654752, 0.70710678118654752});
  }
  for (const auto& [child, parent] :
       {std::pair("FL_hip_link", "trunk"), {"FL_thigh_link", "FL_hip_link"}}) {
    tf = after_header(tf, parent);
    EXPECT_EQ(text(tf), child);
    for (int i = 0; i < 7; ++i) tf.number<double>();
  }
  expect_end(tf);
  EXPECT_GT(odometry.number<double>(), 0.0);  // variance of x
  for (int i = 1; i < 36; ++i) odometry.number<double>();
  expect(odometry, {0.8, 0.0, 0.01, 0.1, 0.2, 0.3});
  for (int i = 0; i < 36; ++i) odometry.number<double>();
  expect_end(odometry);
}

TEST_F(RosMessagesTest, TheRobotsDescriptionAndItsFixedTransformsComeOnce) {
  CdrReader description(messages_["/robot_description"]);
  EXPECT_EQ(text(description), robot_.ros_urdf);
  expect_end(description);
  CdrReader tf(messages_["/tf_static"]);
  EXPECT_EQ(tf.number<std::uint32_t>(), 2u);
  for (const auto& [child, parent] :
       {std::pair("trunk", "base_link"), {"FL_foot", "FL_thigh_link"}}) {
    EXPECT_EQ(tf.number<std::int32_t>(), 1'700'000'000);
    EXPECT_EQ(tf.number<std::uint32_t>(), 900'000'000u);
    EXPECT_EQ(text(tf), parent);
    EXPECT_EQ(text(tf), child);
    for (int i = 0; i < 6; ++i) tf.number<double>();
    EXPECT_EQ(tf.number<double>(), 1.0);  // w
  }
  expect_end(tf);
}

TEST_F(RosMessagesTest, DiagnosticsSayModeAndWhichRobotItIs) {
  CdrReader cdr(messages_["/diagnostics"]);
  EXPECT_EQ(cdr.number<std::int32_t>(), 1'700'000'000);  // those of tick 0
  EXPECT_EQ(cdr.number<std::uint32_t>(), 900'000'000u);
  EXPECT_EQ(text(cdr), "");
  EXPECT_EQ(cdr.number<std::uint32_t>(), 1u);
  EXPECT_EQ(cdr.number<std::uint8_t>(), 0u);
  EXPECT_EQ(text(cdr), "sandrunner");
  EXPECT_EQ(text(cdr), "walk");
  EXPECT_EQ(text(cdr), hardware_id(robot_));
  EXPECT_GT(cdr.number<std::uint32_t>(), 10u);
  EXPECT_EQ(text(cdr), "mode");
  EXPECT_EQ(text(cdr), "walk");
}

}  // namespace
}  // namespace sandrunner
