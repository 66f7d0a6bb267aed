// SPDX-License-Identifier: BSD-3-Clause
// The deployed program and the emulated Unitree robot, two processes on this computer's loopback.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/rt/dds/own_domain.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/unless_stalled.h"

namespace sandrunner {
namespace {

using testing::HasSubstr;

const std::string kWalk_s = "10";  // standing up included

class UnitreeLoopbackTest : public testing::Test {
 protected:
  UnitreeLoopbackTest() {
    std::string text = read_file(SANDRUNNER_UNITREE_EXAMPLE);
    text.replace(text.find("\"eth0\""), 6, "\"lo\"");
    write_file(folder_.path("robot.toml"), fmt::format("{}domain = {}\n", text, own_domain()));
  }

  Ended run(std::vector<std::string> words) const {
    return run_process(std::move(words), {.folder = folder_.path("")});
  }
  nlohmann::json json(const std::string& file) const {
    return nlohmann::json::parse(read_file(folder_.path(file)));
  }
  /// A number of `report`; what is none fails with its name, and NaN.
  static double figure(const nlohmann::json& report, const std::string& path) {
    const nlohmann::json::json_pointer at(path);
    if (report.contains(at) && report.at(at).is_number()) return report.at(at);
    ADD_FAILURE() << path << ": expected a number, found none in " << report.dump(2);
    return std::nan("");
  }
  /// Speed of the same walk in the program's own simulator, m/s.
  double speed_in_process() const {
    const Ended ended = run({SANDRUNNER_PROGRAM, "--robot", "go2", "--command", "1,0,0",
                             "--duration", kWalk_s, "--out", "alone"});
    EXPECT_EQ(ended.code, 0) << ended;
    return ended.code == 0 ? figure(json("alone/summary.json"), "/mean_velocity_mps/0") : 0.0;
  }

  const TemporaryFolder folder_;
};

/// The bench or the wire was held up: what the controller then found says nothing of it.
std::string as_a_stall(double bench_late_ms, const std::string& said) {
  const bool held_up = bench_late_ms > 4.0 || said.find("joints_stale") != std::string::npos;
  return held_up ? said + "loop_stalled" : said;
}

TEST_F(UnitreeLoopbackTest, ChecksStandsWalksAndReplaysAsInProcess) {
  const double expected_mps = speed_in_process();
  ASSERT_FALSE(HasFailure());
  unless_stalled([&](std::string& said) {
    ChildProcess robot(
        {SANDRUNNER_HIL, "--hardware", "robot.toml", "--walk", kWalk_s, "--out", "bench.json"},
        {.folder = folder_.path("")});
    const Ended check = run({SANDRUNNER_PROGRAM, "check", "robot.toml"});
    const Ended walk = run({SANDRUNNER_PROGRAM, "--hardware", "robot.toml", "--arm", "--command",
                            "1,0,0", "--duration", kWalk_s, "--record", "recording"});
    robot.signal(SIGINT);
    const Ended bench = robot.wait();
    // The processes first: figures of a walk that was none say nothing.
    said = check.out + walk.out;
    ASSERT_EQ(bench.code, 0) << bench;
    const nlohmann::json report = json("bench.json");
    said = as_a_stall(figure(report, "/late_longest_ms"), said);
    ASSERT_EQ(check.code, 0) << check;
    EXPECT_THAT(check.out, HasSubstr("all is well; nothing was powered"));
    ASSERT_EQ(walk.code, 0) << walk;
    EXPECT_EQ(report.at("commands").at("refused"), 0) << report;
    EXPECT_TRUE(report.at("off_at_end"));
    EXPECT_FALSE(report.at("walk").at("base_touched"));
    EXPECT_NEAR(figure(report, "/walk/mean_speed_mps"), expected_mps, 0.05 * expected_mps);
    const Ended replay = run({SANDRUNNER_REPLAY, "recording/run.mcap"});
    EXPECT_EQ(replay.code, 0) << replay;
    EXPECT_THAT(replay.out, HasSubstr("every bit agrees"));
  });
}

TEST_F(UnitreeLoopbackTest, WhatGoesWrongEndsAsTheTableSays) {
  // A few of them, each of another kind; the whole list takes ten minutes.
  const Ended ended = run({SANDRUNNER_HIL, "unitree-runs", "--controller", SANDRUNNER_PROGRAM,
                           "--hardware", "robot.toml", "--out", "runs", "--only",
                           "gap-20,hot,foreign,remote-stop,wrong-type,crash,stop,hang"});
  EXPECT_EQ(ended.code, 0) << ended;
}

}  // namespace
}  // namespace sandrunner
