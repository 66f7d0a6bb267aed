// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/telemetry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/rt/telemetry/dds/support.h"
#include "tests/rt/telemetry/example_tick.h"

namespace sandrunner {
namespace {

// Telemetry with a peer that is there first.
struct Published {
  Published() : config(test_config()), participant(config), peer(config) {}
  void publish(std::uint64_t ticks) {
    Telemetry telemetry(participant, config, example_robot(), nullptr, RunClock::kRealtime);
    telemetry.begin(kExampleStart_ns);
    for (std::uint64_t tick = 0; tick < ticks; ++tick) telemetry.add(example_tick(tick));
    EXPECT_EQ(telemetry.failed_writes(), 0u);
  }
  DdsConfig config;
  DdsParticipant participant;
  Peer peer;
};

TEST(TelemetryTest, JointStatesHaveTheRobotsNamesValuesStampsAndTheRateThatWasAskedFor) {
  Published setup;
  const auto reader = setup.peer.reader("rt/joint_states", sensor_msgs_msg_dds__JointState__desc);
  setup.publish(4001);
  const RobotDescription robot = example_robot();
  int n = 0;
  const auto count = take<sensor_msgs_msg_dds__JointState_>(
      reader, [&](const sensor_msgs_msg_dds__JointState_& m) {
        const std::uint64_t tick = 40 * static_cast<std::uint64_t>(++n);
        const std::int64_t stamp_ns = kExampleStart_ns + static_cast<std::int64_t>(tick) * 250'000;
        EXPECT_STREQ(m.header.frame_id, "base_link");
        EXPECT_EQ(m.header.stamp.sec, stamp_ns / 1'000'000'000);
        EXPECT_EQ(m.header.stamp.nanosec, stamp_ns % 1'000'000'000);
        ASSERT_EQ(m.name._length, 12u);
        ASSERT_EQ(m.position._length, 12u);
        ASSERT_EQ(m.velocity._length, 12u);
        ASSERT_EQ(m.effort._length, 12u);
        for (int j = 0; j < 12; ++j) {
          EXPECT_STREQ(m.name._buffer[j], robot.joint_names[j].c_str());
          EXPECT_EQ(m.position._buffer[j], 0.1 * j + 1e-6 * static_cast<double>(tick));
          EXPECT_EQ(m.velocity._buffer[j], 1.0 + j);
          EXPECT_EQ(m.effort._buffer[j], -2.0 - j);
        }
      });
  EXPECT_EQ(count, 100);
}

TEST(TelemetryTest, ImuIsWhatTheSensorSaid) {
  Published setup;
  const auto reader = setup.peer.reader("rt/imu/data", sensor_msgs_msg_dds__Imu__desc);
  setup.publish(41);
  const auto count =
      take<sensor_msgs_msg_dds__Imu_>(reader, [](const sensor_msgs_msg_dds__Imu_& m) {
        EXPECT_STREQ(m.header.frame_id, "base_link");
        EXPECT_EQ(m.orientation.w, 0.70710678118654752);
        EXPECT_EQ(m.orientation.x, 0.0);
        EXPECT_EQ(m.orientation.z, 0.70710678118654752);
        EXPECT_EQ(m.angular_velocity.y, 0.2);
        EXPECT_EQ(m.linear_acceleration.z, 9.8);
        EXPECT_EQ(m.orientation_covariance[0], 0.0);
      });
  EXPECT_EQ(count, 1);
}

TEST(TelemetryTest, OdometryAndTfIntegrateTheEstimatedVelocityInTheWorld) {
  Published setup;
  const auto odom = setup.peer.reader("rt/odom", nav_msgs_msg_dds__Odometry__desc);
  const auto tf = setup.peer.reader("rt/tf", tf2_msgs_msg_dds__TFMessage__desc);
  setup.publish(8001);
  double last_variance_m2 = -1.0, y_m = 0.0;
  const auto count =
      take<nav_msgs_msg_dds__Odometry_>(odom, [&](const nav_msgs_msg_dds__Odometry_& m) {
        EXPECT_STREQ(m.header.frame_id, "odom");
        EXPECT_STREQ(m.child_frame_id, "base_link");
        EXPECT_GT(m.pose.covariance[0], last_variance_m2);
        EXPECT_GT(m.pose.covariance[35], 0.0);
        last_variance_m2 = m.pose.covariance[0];
        y_m = m.pose.pose.position.y;
        EXPECT_NEAR(m.pose.pose.position.x, 0.0, 1e-9);
        EXPECT_EQ(m.pose.pose.position.z, 0.45);
        EXPECT_EQ(m.twist.twist.linear.x, 0.8);
        EXPECT_EQ(m.twist.twist.angular.z, 0.3);
      });
  EXPECT_EQ(count, 200);
  EXPECT_NEAR(y_m, 1.6, 1e-6);
  double tf_y_m = 0.0;
  take<tf2_msgs_msg_dds__TFMessage_>(tf, [&](const tf2_msgs_msg_dds__TFMessage_& m) {
    ASSERT_EQ(m.transforms._length, 3u);  // and the two links that a joint turns
    EXPECT_STREQ(m.transforms._buffer[0].header.frame_id, "odom");
    EXPECT_STREQ(m.transforms._buffer[0].child_frame_id, "base_link");
    tf_y_m = m.transforms._buffer[0].transform.translation.y;
    EXPECT_EQ(m.transforms._buffer[0].transform.rotation.w, 0.70710678118654752);
  });
  EXPECT_EQ(tf_y_m, y_m);
}

TEST(TelemetryTest, TheTransformsLeadFromOdomToTheFeetAndFixedOnesReachAPeerThatComesLater) {
  Published setup;
  const auto tf = setup.peer.reader("rt/tf", tf2_msgs_msg_dds__TFMessage__desc);
  setup.publish(41);
  const auto fixed = setup.peer.reader("rt/tf_static", tf2_msgs_msg_dds__TFMessage__desc, true);
  std::map<std::string, std::string> parents;
  std::map<std::string, geometry_msgs_msg_dds__Transform_> transforms;
  const auto add = [&](const tf2_msgs_msg_dds__TFMessage_& m) {
    for (std::uint32_t i = 0; i < m.transforms._length; ++i) {
      const auto& t = m.transforms._buffer[i];
      EXPECT_TRUE(parents.emplace(t.child_frame_id, t.header.frame_id).second);
      transforms[t.child_frame_id] = t.transform;
    }
  };
  take<tf2_msgs_msg_dds__TFMessage_>(tf, add);
  EXPECT_TRUE(wait_until([&] { return take<tf2_msgs_msg_dds__TFMessage_>(fixed, add) > 0; }));
  EXPECT_EQ(parents, (std::map<std::string, std::string>{{"base_link", "odom"},
                                                         {"trunk", "base_link"},
                                                         {"FL_hip_link", "trunk"},
                                                         {"FL_thigh_link", "FL_hip_link"},
                                                         {"FL_foot", "FL_thigh_link"}}));
  const double thigh_rad = 0.1 + 1e-6 * 40;  // of the joint about y, in tick 40
  EXPECT_EQ(transforms["FL_thigh_link"].translation.y, 0.05);
  EXPECT_EQ(transforms["FL_thigh_link"].rotation.y, std::sin(thigh_rad / 2));
  EXPECT_EQ(transforms["FL_thigh_link"].rotation.w, std::cos(thigh_rad / 2));
  EXPECT_EQ(transforms["FL_foot"].translation.z, -0.4);
}

TEST(TelemetryTest, TheDescriptionReachesAPeerThatComesLater) {
  Published setup;
  setup.publish(1);
  const auto reader =
      setup.peer.reader("rt/robot_description", std_msgs_msg_dds__String__desc, true);
  std::string text;
  EXPECT_TRUE(wait_until([&] {
    return take<std_msgs_msg_dds__String_>(
               reader, [&](const std_msgs_msg_dds__String_& m) { text = m.data; }) > 0;
  }));
  EXPECT_EQ(text, example_robot().ros_urdf);
}

TEST(TelemetryTest, DiagnosticsComeOnceASecondWithModeFaultsTimesAndTheGatesCounters) {
  Published setup;
  const auto reader =
      setup.peer.reader("rt/diagnostics", diagnostic_msgs_msg_dds__DiagnosticArray__desc);
  {
    Telemetry telemetry(setup.participant, setup.config, example_robot(), nullptr,
                        RunClock::kRealtime);
    for (std::uint64_t tick = 0; tick <= 12000; ++tick) {
      TickRecord record = example_tick(tick);
      if (tick == 6000) record.skipped = 3;
      std::uint64_t count = 100;
      for (const GateCounterName& counter : kGateCounters) record.counters.*counter.ticks = count++;
      if (tick > 8000) {
        record.output.mode = Mode::kFault;
        record.output.faults =
            static_cast<std::uint64_t>(Fault::kTilt) | static_cast<std::uint64_t>(Fault::kImuStale);
        record.output.fault_joints = 1u << 0 | 1u << 11;
      }
      telemetry.add(record);
    }
  }
  std::vector<int> levels;
  std::map<std::string, std::string> values;
  take<diagnostic_msgs_msg_dds__DiagnosticArray_>(
      reader, [&](const diagnostic_msgs_msg_dds__DiagnosticArray_& m) {
        ASSERT_EQ(m.status._length, 1u);
        const auto& status = m.status._buffer[0];
        levels.push_back(status.level);
        EXPECT_EQ(status.hardware_id, hardware_id(example_robot()));
        EXPECT_EQ(std::string(status.hardware_id).rfind("example@", 0), 0u);
        for (std::uint32_t i = 0; i < status.values._length; ++i) {
          values[status.values._buffer[i].key] = status.values._buffer[i].value;
        }
      });
  EXPECT_EQ(levels, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(values["mode"], "fault");
  EXPECT_EQ(values["faults"], "imu_stale, tilt");
  EXPECT_EQ(values["fault_joints"], "FL_hip, RR_calf");
  EXPECT_EQ(values["tick"], "12000");
  EXPECT_EQ(values["slots_missed"], "3");
  EXPECT_EQ(values["tick_late_us"], "p50 2.0, p99 2.0, p99.9 2.0, max 2.0");
  std::uint64_t count = 100;
  for (const GateCounterName& counter : kGateCounters) {
    EXPECT_EQ(values["ticks_" + std::string(counter.name)], std::to_string(count++));
  }
}

TEST(TelemetryTest, InLockstepTheClockHasTheMessagesStampsAndDoesNotRunAheadOfTheWall) {
  Published setup;
  const auto clock = setup.peer.reader("rt/clock", rosgraph_msgs_msg_dds__Clock__desc);
  const auto joints = setup.peer.reader("rt/joint_states", sensor_msgs_msg_dds__JointState__desc);
  const auto start = std::chrono::steady_clock::now();
  {
    Telemetry telemetry(setup.participant, setup.config, example_robot(), nullptr,
                        RunClock::kLockstep);
    telemetry.begin(kExampleStart_ns);
    for (std::uint64_t tick = 0; tick <= 400; ++tick) telemetry.add(example_tick(tick));
  }
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(100));
  std::vector<std::int64_t> times_ns, stamps_ns;
  const auto ns = [](const builtin_interfaces_msg_dds__Time_& t) {
    return t.sec * std::int64_t{1'000'000'000} + t.nanosec;
  };
  take<rosgraph_msgs_msg_dds__Clock_>(
      clock, [&](const rosgraph_msgs_msg_dds__Clock_& m) { times_ns.push_back(ns(m.clock)); });
  take<sensor_msgs_msg_dds__JointState_>(joints, [&](const sensor_msgs_msg_dds__JointState_& m) {
    stamps_ns.push_back(ns(m.header.stamp));
  });
  EXPECT_EQ(times_ns.size(), 10u);
  EXPECT_EQ(times_ns.front(), kExampleStart_ns + 10'000'000);
  EXPECT_EQ(times_ns, stamps_ns);
}

TEST(TelemetryTest, EveryTickIsInTheBatchesOnceAndInOrder) {
  Published setup;
  const auto reader = setup.peer.reader("sandrunner/ticks", sandrunner_TickBatch_desc);
  setup.publish(4010);
  std::uint64_t batches = 0, ticks = 0;
  take<sandrunner_TickBatch>(reader, [&](const sandrunner_TickBatch& m) {
    EXPECT_EQ(m.sequence_number, ++batches);
    EXPECT_EQ(m.stamp_ns, kExampleStart_ns + static_cast<std::int64_t>(ticks) * 250'000);
    EXPECT_EQ(m.ticks._length, batches <= 100 ? 40u : 10u);  // the last ones at the end
    for (std::uint32_t i = 0; i < m.ticks._length; ++i) {
      EXPECT_EQ(m.ticks._buffer[i].tick, ticks++);
    }
    const sandrunner_TickState& s = m.ticks._buffer[0];
    const TickRecord record = example_tick(s.tick);
    EXPECT_EQ(s.mode, static_cast<std::uint32_t>(Mode::kWalk));
    EXPECT_EQ(s.position_rad[3], static_cast<float>(record.input.sensors.joints.position_rad[3]));
    EXPECT_EQ(s.torque_nm[11], -13.0f);
    EXPECT_EQ(s.target_rad[2], -0.52f);
    EXPECT_EQ(s.kp_nmprad[1], 51.0f);
    EXPECT_EQ(s.kd_nmsprad[1], 1.5f);
    EXPECT_EQ(s.angular_velocity_radps[2], 0.3f);
    EXPECT_EQ(s.command[1], -0.1f);
    EXPECT_EQ(s.body_height_m, 0.45f);
    EXPECT_EQ(s.body_velocity_mps[0], 0.8f);
    EXPECT_EQ(s.foot_height_m[3], 0.04f);
    EXPECT_EQ(s.write_ns, 5000u);
  });
  EXPECT_EQ(batches, 101u);
  EXPECT_EQ(ticks, 4010u);
}

}  // namespace
}  // namespace sandrunner
