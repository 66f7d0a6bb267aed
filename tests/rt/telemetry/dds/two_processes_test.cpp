// SPDX-License-Identifier: BSD-3-Clause
// What only shows between processes: deaths, stops, certificates.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/rt/telemetry/dds/support.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/support/child_process.h"

namespace sandrunner {
namespace {

std::vector<std::string> peer_command(const DdsConfig& config, std::vector<std::string> words) {
  words.insert(words.begin(), {SANDRUNNER_DDS_PEER, std::to_string(config.domain), "lo"});
  return words;
}

// What rmw_cyclonedds adds to the environment's settings, by version and discovery range.
TEST(TwoProcessesTest, RmwCycloneddsUnderRos2LocalhostFindsTheRobotThroughItsDefaultInterface) {
  const std::string index =
      "<CycloneDDS><Domain><Discovery><ParticipantIndex>auto</ParticipantIndex>"
      "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex></Discovery></Domain></CycloneDDS>,";
  for (const std::string& added : {std::string(), index}) {  // Humble; since Iron
    SCOPED_TRACE(added);
    const DdsConfig config = test_config();
    const TakenPorts others(config.domain, 40);  // more than the default of either
    DdsParticipant participant(config);
    Telemetry telemetry(participant, config, example_robot(), nullptr, RunClock::kRealtime);
    sleep_s(0.3);  // the robot has announced itself twice, and does so again in 8 s only
    ChildProcess peer({"bash", "-c",
                       "source " SANDRUNNER_ROS2_LOCALHOST " && exec " SANDRUNNER_DDS_PEER " " +
                           std::to_string(config.domain) + " '" + added +
                           "'\"$CYCLONEDDS_URI\" stock 4"});
    publish_for(telemetry, 0, 4.0);
    EXPECT_GE(number_after(peer.wait().out, "odom"), 100.0);
  }
}

TEST(TwoProcessesTest, Ros2LocalhostFindsItsProfileFromBashAndZshInAnyFolder) {
  for (const std::string shell : {"bash", "zsh"}) {
    if (run_shell("command -v " + shell).code != 0) continue;
    const Ended ended = run_shell("cd / && " + shell +
                                  " -c 'source " SANDRUNNER_ROS2_LOCALHOST
                                  " && head -c 5 \"$FASTDDS_DEFAULT_PROFILES_FILE\"'");
    EXPECT_EQ(ended.code, 0) << shell << ": " << ended.err;
    EXPECT_EQ(ended.out, "<?xml") << shell;
  }
}

TEST(TwoProcessesTest, AStoppedSubscriberHoldsUpNobodyAndALiveOneMissesNothing) {
  const DdsConfig config = test_config();
  DdsParticipant participant(config);
  Telemetry telemetry(participant, config, example_robot(), nullptr, RunClock::kRealtime);
  ChildProcess live(peer_command(config, {"watch", "8"}));
  ChildProcess stopped(peer_command(config, {"watch", "60"}));
  ASSERT_TRUE(live.wait_for("watching"));
  ASSERT_TRUE(stopped.wait_for("watching"));
  publish_for(telemetry, 0, 1.0);
  ASSERT_TRUE(live.wait_for("matched"));
  ASSERT_TRUE(stopped.wait_for("matched"));
  stopped.signal(SIGSTOP);
  const double longest_s = publish_for(telemetry, 4000, 3.5);
  stopped.signal(SIGKILL);
  publish_for(telemetry, 18000, 0.3);
  EXPECT_EQ(telemetry.failed_writes(), 0u);
  EXPECT_LT(longest_s, 0.5);  // half a second of ticks is what the control loop's ring holds
  EXPECT_EQ(number_after(live.wait().out, "gaps"), 0);
  EXPECT_GT(number_after(live.wait().out, "ticks"), 14000);  // at least all since the stop
  RecordProperty("longest_add_us", static_cast<int>(longest_s * 1e6));
}

class SecurityTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    dir_ = std::filesystem::temp_directory_path() /
           ("sandrunner-dds-security-" + std::to_string(getpid()));
    std::filesystem::create_directory(dir_);
    have_openssl_ = run_shell("command -v openssl").code == 0;
    if (!have_openssl_) return;
    for (const char* name : {"ours", "theirs"}) {
      const Ended made = run_process({SANDRUNNER_SECURITY_SCRIPT, folder(name)});
      ASSERT_EQ(made.code, 0) << made;
    }
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(dir_); }
  void SetUp() override {
    if (!have_openssl_) GTEST_SKIP() << "no openssl: no certificates";
  }

  static DdsConfig our_config() {
    DdsConfig config = test_config();
    config.security_dir = folder("ours");
    return config;
  }
  // What a robot of "ours" accepts from a peer that sends 50 commands.
  struct Outcome {
    CommandCounts counts;
    std::string said;
  };
  static Outcome try_to_drive(const std::vector<std::string>& credentials) {
    LiveSetup setup(our_config());
    std::vector<std::string> words{"drive", "0.5", "50"};
    words.insert(words.end(), credentials.begin(), credentials.end());
    ChildProcess peer(peer_command(setup.config, words));
    const std::string said = peer.wait().out;
    return {setup.desk.counts(), said};
  }
  static std::string folder(const char* name) { return (dir_ / name).string(); }

  static inline std::filesystem::path dir_;
  static inline bool have_openssl_ = false;
};

TEST_F(SecurityTest, AnOperatorsCommandsAreAccepted) {
  LiveSetup setup(our_config());
  ChildProcess peer(
      peer_command(setup.config, {"drive", "0.5", "1000", folder("ours"), "operator"}));
  EXPECT_TRUE(wait_until([&] { return setup.desk.counts().accepted >= 50; }, 20));
  EXPECT_EQ(setup.desk.counts().other_publisher, 0u);
}

TEST_F(SecurityTest, WithoutACertificateNothingIsAccepted) {
  const Outcome outcome = try_to_drive({});
  EXPECT_EQ(outcome.said, "sent 50\n");
  EXPECT_EQ(outcome.counts.accepted, 0u);
}

TEST_F(SecurityTest, AnOperatorOfAnotherAuthorityIsNotAccepted) {
  const Outcome outcome = try_to_drive({folder("theirs"), "operator"});
  EXPECT_EQ(outcome.said, "sent 50\n");
  EXPECT_EQ(outcome.counts.accepted, 0u);
}

TEST_F(SecurityTest, AViewerMayNotCommandButSeesTheTelemetry) {
  const Outcome outcome = try_to_drive({folder("ours"), "viewer"});
  EXPECT_EQ(outcome.said.rfind("refused: ", 0), 0u) << outcome.said;
  EXPECT_EQ(outcome.counts.accepted, 0u);

  const DdsConfig config = our_config();
  DdsParticipant participant(config);
  Telemetry telemetry(participant, config, example_robot(), nullptr, RunClock::kRealtime);
  ChildProcess viewer(peer_command(config, {"watch", "60", folder("ours"), "viewer"}));
  ASSERT_TRUE(viewer.wait_for("watching"));
  std::uint64_t tick = 0;
  EXPECT_TRUE(wait_until(
      [&] {
        publish_for(telemetry, tick, 0.5);
        tick += ticks_from_s(0.5);
        return viewer.has_printed("matched");
      },
      20));
  viewer.signal(SIGINT);
  EXPECT_TRUE(viewer.wait_for("matched"));
}

TEST_F(SecurityTest, AMissingFileIsNamed) {
  DdsConfig config = test_config();
  config.security_dir = folder("nowhere");
  try {
    DdsParticipant participant(config);
    FAIL();
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find("nowhere/"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace sandrunner
