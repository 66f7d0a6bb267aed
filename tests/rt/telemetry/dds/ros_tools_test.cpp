// SPDX-License-Identifier: BSD-3-Clause
// What ROS 2's tools find beside the topics: services, nodes, and what stands in their way.
#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "rt/telemetry/dds/ros_node.h"
#include "tests/rt/telemetry/dds/support.h"
#include "tests/rt/telemetry/example_tick.h"

namespace sandrunner {
namespace {

/// A client of one service, as rmw_cyclonedds makes it.
class Caller {
 public:
  Caller(Peer& peer, const std::string& request)
      : replies_(peer.reader(("rr/sandrunner/" + request + "Reply").c_str(),
                             std_srvs_srv_dds__Trigger_Response__desc)),
        calls_(peer.writer(("rq/sandrunner/" + request + "Request").c_str(),
                           std_srvs_srv_dds__Trigger_Request__desc)) {}

  struct Reply {
    std::uint64_t client = 0;
    std::int64_t number = 0;
    bool success = false;
    std::string message = "no reply";
  };
  Reply call(std::int64_t number) {
    const std_srvs_srv_dds__Trigger_Request_ call{
        .client = 0xc11e47, .number = number, .structure_needs_at_least_one_member = 0};
    dds_write(calls_, &call);
    Reply reply;
    wait_until([&] {
      return take<std_srvs_srv_dds__Trigger_Response_>(
                 replies_, [&](const std_srvs_srv_dds__Trigger_Response_& r) {
                   reply = {r.client, r.number, r.success, r.message};
                 }) > 0;
    });
    return reply;
  }

 private:
  dds_entity_t replies_, calls_;
};

/// Values of the diagnostics that telemetry publishes at the end of its first second, and their
/// message as "message".
std::map<std::string, std::string> diagnostics_of(LiveSetup& setup, Peer& peer) {
  const auto reader = peer.reader("rt/diagnostics", diagnostic_msgs_msg_dds__DiagnosticArray__desc);
  Telemetry telemetry(setup.participant, setup.config, example_robot(), &setup.desk,
                      RunClock::kRealtime);
  telemetry.begin(kExampleStart_ns);
  for (std::uint64_t tick = 0; tick <= kControlHz; ++tick) telemetry.add(example_tick(tick));
  std::map<std::string, std::string> values;
  take<diagnostic_msgs_msg_dds__DiagnosticArray_>(
      reader, [&](const diagnostic_msgs_msg_dds__DiagnosticArray_& m) {
        const auto& status = m.status._buffer[0];
        for (std::uint32_t i = 0; i < status.values._length; ++i) {
          values[status.values._buffer[i].key] = status.values._buffer[i].value;
        }
        values["message"] = status.message;
        values["level"] = std::to_string(status.level);
      });
  return values;
}

TEST(RosToolsTest, AServiceCallDoesWhatTheModeRequestDoesAndSaysTheSame) {
  LiveSetup setup;
  Peer peer(setup.config);
  Asker asker(peer);
  Caller stand(peer, "stand"), arm(peer, "arm"), damp(peer, "damp");
  const Caller::Reply refused = stand.call(5);
  EXPECT_EQ(refused.client, 0xc11e47u);
  EXPECT_EQ(refused.number, 5);
  EXPECT_FALSE(refused.success);
  EXPECT_EQ(refused.message, asker.ask("stand").reason);
  EXPECT_EQ(setup.robot.mode(), Mode::kPassive);

  const Caller::Reply armed = arm.call(6);
  EXPECT_TRUE(armed.success);
  EXPECT_EQ(armed.message, "mode damping");
  EXPECT_TRUE(stand.call(7).success);
  EXPECT_TRUE(wait_until([&] { return setup.robot.mode() == Mode::kStand; }));
  EXPECT_EQ(setup.desk.last_request(), "stand: accepted: mode stand_up");
  EXPECT_TRUE(damp.call(8).success);
  EXPECT_EQ(setup.robot.mode(), Mode::kDamping);
  EXPECT_EQ(setup.desk.counts().requests_accepted, 3u);
  EXPECT_EQ(setup.desk.counts().requests_refused, 2u);
}

TEST(RosToolsTest, AStringIsARequestToo) {
  LiveSetup setup;
  Peer peer(setup.config);
  const auto writer = peer.writer("rt/sandrunner/request", std_msgs_msg_dds__String__desc);
  for (const char* request : {"fly", "arm"}) {
    const std_msgs_msg_dds__String_ message{const_cast<char*>(request)};
    dds_write(writer, &message);
  }
  EXPECT_TRUE(wait_until([&] { return setup.robot.mode() == Mode::kDamping; }));
  EXPECT_TRUE(wait_until([&] { return setup.desk.counts().requests_accepted == 1; }));
  EXPECT_EQ(setup.desk.counts().requests_refused, 1u);
  EXPECT_EQ(diagnostics_of(setup, peer)["last_request"], "arm: accepted: mode damping");
}

TEST(RosToolsTest, WhileASecondRobotWouldObeyTooNothingIsSetInMotion) {
  LiveSetup setup;
  Peer peer(setup.config);
  Asker asker(peer);
  const std::string here = "process " + std::to_string(getpid());
  {
    Peer second(setup.config);
    second.writer("sandrunner/mode_reply", sandrunner_ModeReply_desc);
    EXPECT_TRUE(wait_until(
        [&] { return std::string(asker.ask("arm").reason).find(here) != std::string::npos; }));
    EXPECT_EQ(setup.robot.mode(), Mode::kPassive);
    auto values = diagnostics_of(setup, peer);
    EXPECT_NE(values["other_robots"].find(here), std::string::npos) << values["other_robots"];
    EXPECT_EQ(values["level"], "1");
    EXPECT_NE(values["message"].find("another robot would obey as well"), std::string::npos);
  }
  EXPECT_TRUE(wait_until([&] { return asker.ask("arm").accepted; }));
  EXPECT_STREQ(asker.ask("damp").robot, "example@here");
}

TEST(RosToolsTest, VelocitiesOfTheOtherTypeAreNotReadButNoticed) {
  LiveSetup setup;
  Peer peer(setup.config);
  EXPECT_EQ(diagnostics_of(setup, peer)["other_cmd_vel_types"], "");
  const auto stamped =
      peer.writer("rt/cmd_vel", geometry_msgs_msg_dds__TwistStamped__desc, /*readers=*/0);
  EXPECT_GT(stamped, 0);
  auto values = diagnostics_of(setup, peer);
  EXPECT_EQ(values["other_cmd_vel_types"], "geometry_msgs::msg::dds_::TwistStamped_");
  EXPECT_EQ(values["level"], "1");
}

TEST(RosToolsTest, TheNodeIsAnnouncedWithItsTopicsToThoseThatComeLater) {
  const DdsConfig config = test_config();
  DdsParticipant participant(config);
  const auto writer = participant.writer("rt/odom", nav_msgs_msg_dds__Odometry__desc, 1);
  announce_node(participant, "sandrunner");
  Peer peer(config);
  const auto reader = peer.reader("ros_discovery_info",
                                  rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc, true);
  int came = 0;
  const auto look = [&](const rmw_dds_common_msg_dds__ParticipantEntitiesInfo_& m) {
    ++came;
    dds_guid_t own, of_writer;
    dds_get_guid(participant.entity(), &own);
    dds_get_guid(writer, &of_writer);
    EXPECT_EQ(std::memcmp(m.gid.data, own.v, sizeof own.v), 0);
    ASSERT_EQ(m.node_entities_info_seq._length, 1u);
    const auto& node = m.node_entities_info_seq._buffer[0];
    EXPECT_STREQ(node.node_namespace, "/");
    EXPECT_STREQ(node.node_name, "sandrunner");
    EXPECT_EQ(node.reader_gid_seq._length, 0u);
    ASSERT_EQ(node.writer_gid_seq._length, 1u);
    EXPECT_EQ(std::memcmp(node.writer_gid_seq._buffer[0].data, of_writer.v, sizeof own.v), 0);
  };
  EXPECT_TRUE(wait_until(
      [&] { return take<rmw_dds_common_msg_dds__ParticipantEntitiesInfo_>(reader, look) > 0; }));
  EXPECT_EQ(came, 1);
}

}  // namespace
}  // namespace sandrunner
