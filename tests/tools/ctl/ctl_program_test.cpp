// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-ctl as an operator runs it, against a robot in this process.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include "fake_robot.h"
#include "program.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner::ctl {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

auto lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

Ended run(std::vector<std::string> words, const DdsConfig& config) {
  return Program(std::move(words), config).wait();
}

void make_walk(const FakeRobot& robot, const DdsConfig& config) {
  EXPECT_EQ(run({"mode", "arm"}, config).code, 0);
  EXPECT_EQ(run({"mode", "stand"}, config).code, 0);
  EXPECT_TRUE(robot.wait_for(Mode::kStand));
  EXPECT_EQ(run({"mode", "walk"}, config).code, 0);
}

void expect_error(const Ended& ended, int code, const std::string& part) {
  EXPECT_EQ(ended.code, code);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(lines(ended.err), 1) << ended.err;
  EXPECT_EQ(ended.err.rfind("sandrunner-ctl: ", 0), 0u) << ended.err;
  EXPECT_TRUE(has(ended.err, part)) << ended.err;
}

TEST(CtlProgramTest, BadInputIsOneLineAndExitCodeTwo) {
  const DdsConfig config = test_config();
  expect_error(run({"mode", "jump"}, config), 2, "mode: found 'jump'");
  expect_error(run({"cmd", "nan", "0", "0"}, config), 2, "VX: found nan");
  expect_error(run({}, config), 2, "found no command, expected status");
  expect_error(run({"drive"}, config), 2, "not a terminal");
  expect_error(run({"status", "--once", "--security", "/nowhere"}, config), 2, "/nowhere/");
  expect_error(run({"status", "--once", "--interface", "nosuch0"}, config), 2,
               "on interface nosuch0: found no such interface, expected one of lo");
}

TEST(CtlProgramTest, WithoutARobotItSaysSoWithExitCodeOne) {
  const DdsConfig config = test_config();
  DdsParticipant us(config);
  Program status({"status"}, config), mode({"mode", "damp"}, config),
      cmd({"cmd", "0", "0", "0"}, config);
  expect_error(status.wait(), 1, "no robot: no message came in domain");
  expect_error(mode.wait(), 1, "damp: no robot answered in domain");
  expect_error(cmd.wait(), 1, "no robot listens on rt/cmd_vel in domain");
}

TEST(CtlProgramTest, ARobotThatDoesNotAnswerIsWaitedForTwoSeconds) {
  const DdsConfig config = test_config();
  DdsParticipant us(config);
  const dds_entity_t requests =
      us.reader("sandrunner/mode_request", sandrunner_ModeRequest_desc, 1, true);
  const dds_entity_t replies = us.writer("sandrunner/mode_reply", sandrunner_ModeReply_desc, 1);
  const auto start = std::chrono::steady_clock::now();
  Program program({"mode", "damp"}, config);
  // An answer to another operator's request.
  sandrunner_ModeReply reply{};
  ASSERT_TRUE(wait_until([&] {
    return take<sandrunner_ModeRequest>(
               requests, [&](const auto& request) { reply.id = request.id + 1; }) > 0;
  }));
  reply.accepted = true;
  dds_write(replies, &reply);
  expect_error(program.wait(), 1, "damp: no answer");
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_GE(took.count(), 2.0);
}

TEST(CtlProgramTest, ModePrintsWhatTheRobotSays) {
  const DdsConfig config = test_config();
  FakeRobot robot(config);
  expect_error(
      run({"mode", "walk"}, config), 1,
      "walk: refused by example@here in mode passive: the robot does not stand, stand comes first");
  expect_error(run({"mode", "reset_fault"}, config), 1,
               "refused by example@here in mode passive: no fault");
  Ended ended = run({"mode", "arm"}, config);
  EXPECT_EQ(ended.out, "arm: accepted by example@here, mode damping\n") << ended.err;
  ended = run({"mode", "stand"}, config);
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.out, "stand: accepted by example@here, mode stand_up\n");
  ASSERT_TRUE(robot.wait_for(Mode::kStand));
  ended = run({"mode", "walk"}, config);
  EXPECT_EQ(ended.out, "walk: accepted by example@here, mode walk\n") << ended.err;
  ended = run({"mode", "stop"}, config);
  EXPECT_TRUE(has(ended.out, "stop: accepted by example@here, mode ")) << ended.err;
  ended = run({"mode", "damp"}, config);
  EXPECT_EQ(ended.out, "damp: accepted by example@here, mode damping\n") << ended.err;
  robot.robot().break_joint();
  ASSERT_TRUE(robot.wait_for(Mode::kFault));
  expect_error(run({"mode", "stand"}, config), 1,
               "refused by example@here in mode fault: a fault is latched");
}

TEST(CtlProgramTest, CmdSendsTwentyASecondThenZero) {
  const DdsConfig config = test_config();
  DdsParticipant us(config);
  Peer peer(config);
  CommandLog log(peer);
  const Ended ended = run({"cmd", "0.5", "-0.1", "0.2", "--for", "1"}, config);
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.out, "sent 20 commands in 1.00 s, then zero\n");
  const auto zeros = [&] {
    return std::ranges::count_if(log.entries(), [](auto& e) { return e.is_zero(); });
  };
  ASSERT_TRUE(wait_until([&] { return zeros() == 5; }));
  const auto entries = log.entries();
  const auto zero =
      std::find_if(entries.begin(), entries.end(), [](auto& e) { return e.is_zero(); });
  EXPECT_TRUE(std::all_of(zero, entries.end(), [](auto& e) { return e.is_zero(); }));
  const auto sent = zero - entries.begin();
  ASSERT_GE(sent, 10);  // the first ones may come before this process knows the sender
  EXPECT_LE(sent, 20);
  for (auto e = entries.begin(); e != zero; ++e) {
    EXPECT_EQ(e->vx_mps, 0.5);
    EXPECT_EQ(e->vy_mps, -0.1);
    EXPECT_EQ(e->wz_radps, 0.2);
  }
  std::vector<double> gaps_s;
  for (auto e = entries.begin() + 1; e != zero; ++e) {
    gaps_s.push_back(1e-9 * static_cast<double>(e->sent_ns - (e - 1)->sent_ns));
  }
  std::ranges::sort(gaps_s);
  EXPECT_NEAR(gaps_s[gaps_s.size() / 2], 0.05, 0.02);
}

TEST(CtlProgramTest, CmdWithoutAnEndIsEndedBySignalsWithZero) {
  const DdsConfig config = test_config();
  FakeRobot robot(config);
  make_walk(robot, config);
  Peer peer(config);
  for (const int number : {SIGINT, SIGTERM}) {
    CommandLog log(peer);
    Program program({"cmd", "0.5", "0", "0"}, config);
    ASSERT_TRUE(wait_until([&] { return log.entries().size() >= 5; }));
    program.signal(number);
    const Ended& ended = program.wait();
    EXPECT_EQ(ended.code, 0) << ended.err;
    ASSERT_TRUE(wait_until([&] { return log.entries().back().is_zero(); }));
  }
}

TEST(CtlProgramTest, CmdThatMovesNothingSaysSoWithExitCodeOne) {
  const DdsConfig config = test_config();
  FakeRobot robot(config);
  make_walk(robot, config);
  EXPECT_EQ(run({"cmd", "0.5", "0", "0", "--for", "1"}, config).code, 0);
  EXPECT_EQ(run({"mode", "damp"}, config).code, 0);
  expect_error(run({"cmd", "0.5", "0", "0", "--for", "1"}, config), 1,
               "sent 20 commands, none had an effect: the robot is in mode damping");
}

TEST(CtlProgramTest, AModeRightAfterCmdWaitsForTheVelocityToEnd) {
  DdsConfig config = test_config();
  config.stale_s = 1.0;
  FakeRobot robot(config);
  make_walk(robot, config);
  EXPECT_EQ(run({"cmd", "0.5", "0", "0", "--for", "0.2"}, config).code, 0);
  const Ended ended = run({"mode", "lie"}, config);
  EXPECT_EQ(ended.code, 0) << ended.err;
}

TEST(CtlProgramTest, SignalsEndTheSearchForARobotWithoutAnError) {
  const DdsConfig config = test_config();
  for (const std::vector<std::string>& words : {std::vector<std::string>{"cmd", "0.5", "0", "0"},
                                                std::vector<std::string>{"mode", "stand"}}) {
    Program program(words, config);
    std::this_thread::sleep_for(std::chrono::milliseconds(700));  // of two seconds
    program.signal(SIGINT);
    const Ended& ended = program.wait();
    EXPECT_EQ(ended.code, 0) << words[0] << ": " << ended.err;
    EXPECT_EQ(ended.err, "") << words[0];
  }
}

TEST(CtlProgramTest, CmdSendsTwistStampedWhenTold) {
  DdsConfig config = test_config();
  config.stamped_cmd_vel = true;
  LiveSetup setup(config);
  const Ended ended =
      run({"--cmd-vel", "twist_stamped", "cmd", "0.5", "0", "0", "--for", "0.3"}, config);
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_GE(setup.desk.counts().accepted, 6u);
  expect_error(run({"cmd", "0.5", "0", "0", "--for", "0.3"}, config), 1, "no robot listens");
}

TEST(CtlProgramTest, CmdSaysWhenTheRobotIsGone) {
  const DdsConfig config = test_config();
  auto robot = std::make_unique<LiveSetup>(config);
  Program program({"cmd", "0.5", "0", "0"}, config);
  ASSERT_TRUE(wait_until([&] { return robot->desk.counts().accepted > 3; }));
  robot.reset();
  expect_error(program.wait(), 1, "the robot is gone after ");
}

TEST(CtlProgramTest, StatusOnceShowsTheRobot) {
  const DdsConfig config = test_config();
  FakeRobot robot(config);
  const auto rate = [](const Ended& status, const std::string& name) {  // -1: none, or "-"
    const std::size_t at = status.out.find(name + " ");
    const double value =
        at == std::string::npos ? 0.0 : std::strtod(status.out.c_str() + at + name.size(), nullptr);
    return value > 0.0 ? value : -1.0;
  };
  const struct {
    const char* name;
    double hz, tolerance_hz;
  } rates[] = {{"joint_states", 100.0, 10.0},
               {"odom", 100.0, 10.0},
               {"diagnostics", 1.0, 0.2},
               {"ticks", 4000.0, 400.0}};
  // Again where this computer was held up meanwhile.
  Ended ended;
  for (int tries = 0; tries < 5; ++tries) {
    ended = run({"status", "--once"}, config);
    if (std::ranges::all_of(rates, [&](const auto& r) {
          return std::fabs(rate(ended, r.name) - r.hz) <= r.tolerance_hz;
        })) {
      break;
    }
  }
  EXPECT_EQ(ended.code, 0) << ended.err;
  for (const char* part :
       {"robot          example@", "condition      passive\n", "mode           passive\n",
        "faults         none\nof joints      none\n", "command        0.90 -0.10 m/s 0.20 rad/s\n",
        "speed          0.00 0.00 m/s",
        "late, us       last 2 s: p50 2.0, p99 2.0  since the start: p50 2.0",
        "control, us    last 2 s: p50 4.0, p99 4.0", "write, us      last 2 s: p50 5.0, p99 5.0",
        "slots missed   0 while watching, 0 since the start\n", "messages lost  0 lost and "}) {
    EXPECT_TRUE(has(ended.out, part)) << part << "\n" << ended.out;
  }
  for (const auto& r : rates) {
    EXPECT_NEAR(rate(ended, r.name), r.hz, r.tolerance_hz) << r.name << "\n" << ended.out;
  }
  EXPECT_FALSE(has(ended.out, "\x1b"));
}

TEST(CtlProgramTest, WithSecurityOnlyTheOperatorIsHeard) {
  if (run_shell("command -v openssl").code != 0) GTEST_SKIP() << "no openssl";
  const TemporaryFolder folder;
  const std::string keys = folder.path("keys");
  const Ended made = run_process({SANDRUNNER_SECURITY_SCRIPT, keys});
  ASSERT_EQ(made.code, 0) << made;
  DdsConfig config = test_config();
  config.security_dir = keys;
  FakeRobot robot(config);
  Program stranger({"mode", "stand"}, config);
  const Ended ended = run({"--security", keys, "mode", "arm"}, config);
  EXPECT_EQ(ended.out, "arm: accepted by example@here, mode damping\n") << ended.err;
  EXPECT_TRUE(wait_until([&] {  // a message of the handshake that is lost costs a second
    return has(run({"--security", keys, "status", "--once"}, config).out, "mode           damping");
  }));
  EXPECT_EQ(run({"--security", keys, "cmd", "0", "0", "0", "--for", "0.1"}, config).code, 0);
  expect_error(stranger.wait(), 1, "stand: no robot answered");
}

}  // namespace
}  // namespace sandrunner::ctl
