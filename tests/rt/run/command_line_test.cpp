// SPDX-License-Identifier: BSD-3-Clause
// Good runs of the program: what it prints and writes.
#include <chrono>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "policy/policy_file.h"
#include "rt/base/build.h"
#include "rt/run/signals.h"
#include "sim/robot/robot_model.h"
#include "tests/policy/random_policy.h"
#include "tests/support/program_test.h"
#include "tests/support/small_robot.h"
#include "tests/support/text_match.h"

namespace sandrunner {
namespace {

using Json = nlohmann::json;

class CommandLineTest : public ProgramTest {
 protected:
  CommandLineTest() : ProgramTest(SANDRUNNER_PROGRAM) {
    write_policy_file(folder_.path("policy"), random_policy_file());
  }
  Json summary(const std::string& folder) const {
    return Json::parse(std::ifstream(folder_.path(folder + "/summary.json")));
  }
  /// The state hash that the table shows.
  std::string printed_hash() const {
    const std::string label = "state hash";
    const std::size_t at = output().find_first_not_of(' ', output().find(label) + label.size());
    return output().substr(at, output().find('\n', at) - at);
  }
};

TEST_F(CommandLineTest, HelpNamesEveryOption) {
  EXPECT_EQ(run("--help"), 0);
  EXPECT_EQ(error(), "");
  // The parser writes the help from the options that it knows: none of them is missing here.
  std::set<std::string> options;
  for (const auto& match : matches_in(output(), "\n +(-[a-z],)?(--[a-z-]+)")) {
    options.insert(match[2]);
  }
  EXPECT_EQ(options,
            (std::set<std::string>{
                "--help",    "--version", "--policy",  "--robot",        "--hardware", "--arm",
                "--dry-run", "--terrain", "--command", "--dds-security", "--duration", "--start",
                "--clock",   "--seed",    "--config",  "--set",          "--settings", "--describe",
                "--out",     "--record",  "--view"}))
      << output();
  for (const char* text : {"rt-report", "dry-sand", "athletic-track"}) {
    EXPECT_NE(output().find(text), std::string::npos) << text;
  }
}

TEST_F(CommandLineTest, HelpSpeaksToPeople) {
  run("--help");
  for (const char* marker : {"TEXT", "FLOAT", "UINT", "REQUIRED", "[]", "{"}) {
    EXPECT_EQ(output().find(marker), std::string::npos) << marker << "\n" << output();
  }
  EXPECT_NE(output().find("--seed N "), std::string::npos) << output();
  EXPECT_NE(output().find("(default 20)"), std::string::npos) << output();
  EXPECT_NE(output().find("\nExamples:\n  sandrunner --"), std::string::npos) << output();
  std::istringstream lines(output());
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
}

TEST_F(CommandLineTest, RobotMayLieInAFileOfAnyName) {
  const sim::Robot robot = sim::load_robot(write_small_robot(folder_));
  PolicyFile file = random_policy_file();
  file.spec.joint_names = robot.description.joint_names;
  write_policy_file(folder_.path("policy"), file);
  std::filesystem::copy(folder_.path("small.toml"), folder_.path("a \"= robot\n.toml"));
  run("--robot 'a \"= robot\n.toml' --policy policy --start walk --duration 0.02 --out results");
  EXPECT_EQ(error(), "");
  const std::string config = read_file(folder_.path("results/config.toml"));
  EXPECT_NE(config.find("robot = \"a \\\"= robot\\n.toml\""), std::string::npos) << config;
  EXPECT_NE(config.find("stall_torque_nm = 80"), std::string::npos) << config;
}

TEST_F(CommandLineTest, DescribesARobot) {
  ASSERT_EQ(run("--robot go2 --describe"), 0) << error();
  EXPECT_NE(output().find("# go2\n15.02 kg"), std::string::npos) << output();
}

TEST_F(CommandLineTest, VersionIsOneLine) {
  EXPECT_EQ(run("--version"), 0);
  EXPECT_EQ(output(), "sandrunner " + build_name() + "\n");
}

TEST_F(CommandLineTest, WithoutArgumentsTheRobotEndsOnItsFeet) {
  EXPECT_EQ(run(""), 0);
  EXPECT_EQ(error(), "");
  EXPECT_NE(output().find("finished on its feet"), std::string::npos) << output();
  EXPECT_EQ(files_in(""), std::set<std::string>{"policy"});
}

TEST_F(CommandLineTest, ARobotThatTurnsBackAtOnceIsNotTakenForALiftedOne) {
  // A step of the command; its knees give next to nothing for a moment.
  write_file(folder_.path("back.csv"),
             "t_s,vx,vy,wz\n0,0,0,0\n0.5,0,0,0\n0.500001,3,0,1\n3,3,0,1\n3.000001,-0.8,0,0\n"
             "5.5,-0.8,0,0\n5.500001,3,0,1\n7,3,0,1\n7.000001,0,0,0\n");
  EXPECT_EQ(run("--command back.csv --duration 8 --terrain athletic-track"), 0) << output();
}

TEST_F(CommandLineTest, WithoutAPolicyARobotOfAnyJointsStandsUpAndIsLetDown) {
  const std::string robot = "--robot " + write_small_robot(folder_);
  EXPECT_EQ(run("--policy none --out o " + robot), 0) << error();
  EXPECT_EQ(error(), "");
  EXPECT_TRUE(summary("o").at("policy").is_null());
  const std::string csv = read_file(folder_.path("o/run.csv"));
  EXPECT_NE(csv.find(",stand,"), std::string::npos);
  EXPECT_EQ(csv.find(",walk,"), std::string::npos);
  expect_refused("--policy none --start walk", "--start walk");
}

TEST_F(CommandLineTest, RunWritesItsResults) {
  const int code = run("--policy policy --start walk --duration 0.5 --seed 3 --out deep/results");
  ASSERT_TRUE(code == 0 || code == 1) << error();
  EXPECT_EQ(error(), "");
  EXPECT_EQ(files_in("deep/results"),
            (std::set<std::string>{"summary.json", "config.toml", "run.csv", "run.html"}));
  const std::string csv = read_file(folder_.path("deep/results/run.csv"));
  EXPECT_EQ(csv.substr(0, csv.find(',')), "t_s");
  const Json j = summary("deep/results");
  EXPECT_EQ(j.at("survived").get<bool>(), code == 0);
  EXPECT_EQ(j.at("state_hash"), printed_hash());
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n') - 1,
            static_cast<int>(100.0 * j.at("duration_s").get<double>() + (code == 0 ? 0.0 : 51.0)));
}

TEST_F(CommandLineTest, UnwritableStandardErrorDoesNotChangeTheExitCode) {
  // After a hang-up the terminal refuses what is written to it; /dev/full does so too.
  EXPECT_EQ(run("--nosuch 2>/dev/full"), 2);
}

TEST_F(CommandLineTest, SummaryHasEveryKey) {
  const int code = run("--policy policy --start walk --duration 0.4 --command 1,0,0.25 --out .");
  const Json j = summary(".");
  const std::set<std::string> numbers = {"duration_s",
                                         "mean_yaw_rate_radps",
                                         "foot_clearance_iqr_mm",
                                         "mechanical_power_w",
                                         "torque_squared_nm2",
                                         "followed",
                                         "realtime_factor",
                                         "seed",
                                         "joint_limit_steps",
                                         "speed_limit_steps"};
  std::set<std::string> keys = {"survived",   "fall_time_s", "fall_reason",       "command",
                                "policy",     "terrain",     "version",           "commit",
                                "clock",      "interrupted", "mean_velocity_mps", "sinkage_mm",
                                "estimator",  "state_hash",  "cost_of_transport", "fault_joints",
                                "gate_ticks", "fall_mode"};
  keys.insert(numbers.begin(), numbers.end());
  std::set<std::string> found;
  for (const auto& [key, value] : j.items()) found.insert(key);
  EXPECT_EQ(found, keys);

  for (const std::string& key : numbers) EXPECT_TRUE(j.at(key).is_number()) << key;
  EXPECT_EQ(j.at("command"), "1,0,0.25");
  EXPECT_EQ(j.at("policy"), "random");
  EXPECT_EQ(j.at("terrain"), "dry-sand");
  EXPECT_EQ(j.at("version"), SANDRUNNER_VERSION);
  EXPECT_EQ(j.at("commit"), build_commit());
  EXPECT_EQ(j.at("clock"), "lockstep");
  EXPECT_EQ(j.at("seed"), 0);
  EXPECT_EQ(j.at("interrupted"), false);
  EXPECT_EQ(j.at("survived"), code == 0);
  EXPECT_EQ(j.at("fall_reason").is_null(), code == 0);
  EXPECT_EQ(j.at("fall_time_s").is_null(), code == 0);
  EXPECT_EQ(j.at("fall_mode").is_null(), code == 0);
  EXPECT_LE(j.at("duration_s").get<double>(), 0.4);
  ASSERT_EQ(j.at("mean_velocity_mps").size(), 2u);
  for (const Json& v : j.at("mean_velocity_mps")) EXPECT_LT(std::abs(v.get<double>()), 5.0);
  EXPECT_GE(j.at("sinkage_mm").at("max").get<double>(),
            j.at("sinkage_mm").at("mean").get<double>());
  EXPECT_GE(j.at("sinkage_mm").at("mean").get<double>(), 0.0);
  EXPECT_GT(j.at("torque_squared_nm2").get<double>(), 0.0);
  EXPECT_GT(j.at("realtime_factor").get<double>(), 0.0);
  EXPECT_TRUE(j.at("cost_of_transport").is_null() || j.at("cost_of_transport").is_number());
  for (const char* key : {"velocity_rmse_mps", "body_height_rmse_m", "foot_height_rmse_m"}) {
    EXPECT_GT(j.at("estimator").at(key).get<double>(), 0.0) << key;
  }
  EXPECT_EQ(j.at("state_hash").get<std::string>().size(), 16u);
  EXPECT_EQ(j.at("state_hash").get<std::string>().find_first_not_of("0123456789abcdef"),
            std::string::npos);
}

TEST_F(CommandLineTest, StateHashDependsOnTheRunAndNotOnItsOutput) {
  const std::string walk = "--policy policy --start walk --duration 0.3 ";
  run(walk);
  const std::string hash = printed_hash();
  run(walk);
  EXPECT_EQ(printed_hash(), hash);
  run(walk + "--out results");
  EXPECT_EQ(printed_hash(), hash);
  run(walk + "--terrain rigid --config results/config.toml");  // over another preset
  EXPECT_EQ(printed_hash(), hash);
  run(walk + "--seed 1");
  EXPECT_NE(printed_hash(), hash);
  run(walk + "--set terrain.friction=0.79");
  EXPECT_NE(printed_hash(), hash);
  run(walk + "--command 1.49,0,0");
  EXPECT_NE(printed_hash(), hash);
}

TEST_F(CommandLineTest, LaterSettingsWin) {
  write_file(folder_.path("a.toml"),
             "controller.stand.extend_s = 1.1\ncontroller.stand.fold_s = 1.1");
  write_file(folder_.path("b.toml"), "controller.stand.extend_s = 1.2");
  run("--config a.toml --config b.toml --set controller.stand.kp_nmprad=110 --set "
      "controller.stand.kp_nmprad=120 --terrain rigid --policy policy --duration 0.1 --out .");
  const std::string config = read_file(folder_.path("config.toml"));
  for (const char* line : {"controller.stand.fold_s = 1.1\n", "controller.stand.extend_s = 1.2\n",
                           "controller.stand.kp_nmprad = 120.0\n", "terrain.kind = \"rigid\"\n"}) {
    EXPECT_NE(config.find(line), std::string::npos) << line << config;
  }
}

TEST_F(CommandLineTest, FallIsExitCodeOne) {
  EXPECT_EQ(run("--policy policy --start walk --set controller.walk.kp_nmprad=0 --out results"), 1);
  EXPECT_NE(output().find("FAILED: thigh_contact in walk, after 0."), std::string::npos)
      << output();
  const Json j = summary("results");
  EXPECT_EQ(j.at("survived"), false);
  EXPECT_EQ(j.at("fall_reason"), "thigh_contact");
  EXPECT_EQ(j.at("fall_mode"), "walk");
  EXPECT_EQ(j.at("fall_time_s"), j.at("duration_s"));
}

class InterruptTest : public CommandLineTest {
 protected:
  /// Starts a long run, sends the signal once the robot runs, and returns what was
  /// left. `before`: lines of the shell that come first.
  Ended interrupt(const std::string& arguments, int signal_number, const std::string& before = "",
                  bool close_output = false) {
    ChildProcess child({"sh", "-c",
                        before +
                            "exec '" SANDRUNNER_PROGRAM "' --duration 80000 --terrain rigid "
                            "--out results " +
                            arguments},
                       {.folder = folder_.path("")});
    if (close_output) child.close_out();
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!runs(child.pid()) && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    child.signal(signal_number);
    return child.wait();
  }
  /// Until then a signal ends the start.
  static bool runs(pid_t process) {
    std::error_code gone;
    std::filesystem::directory_iterator task("/proc/" + std::to_string(process) + "/task", gone);
    for (; !gone && task != std::filesystem::directory_iterator(); task.increment(gone)) {
      if (read_file(task->path() / "comm") == std::string(kSignalsThread) + "\n") return true;
    }
    return false;
  }
  /// Writes a policy that holds the nominal pose, so that the robot is still up when the signal
  /// comes.
  std::string calm_policy() const {
    PolicyFile file = random_policy_file();
    file.spec.nominal_position_rad = {0.0, 0.559836, -1.119672, 0.0, 0.559836, -1.119672,
                                      0.0, 0.559836, -1.119672, 0.0, 0.559836, -1.119672};
    file.spec.action_scale_rad.fill(1e-6);
    file.spec.kp_nmprad = 200.0;
    file.spec.kd_nmsprad = 3.0;
    write_policy_file(folder_.path("calm"), file);
    return folder_.path("calm");
  }
};

TEST_F(InterruptTest, WalkEndsInDampingWithItsResults) {
  const std::string calm = calm_policy();
  for (const std::string clock : {"lockstep", "realtime"})
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
      const Ended ended =
          interrupt("--policy " + calm + " --start walk --clock " + clock, signal_number);
      EXPECT_EQ(ended.code, 0);
      const Json j = summary("results");
      EXPECT_EQ(j.at("interrupted"), true);
      EXPECT_EQ(j.at("survived"), true) << j;
      EXPECT_NE(ended.out.find("interrupted, ended in damping"), std::string::npos) << ended.out;
      const std::string csv = read_file(folder_.path("results/run.csv"));
      const std::string last = csv.substr(csv.rfind('\n', csv.size() - 2) + 1);
      EXPECT_NE(last.find(",damping,"), std::string::npos) << last;
      std::filesystem::remove_all(folder_.path("results"));
    }
}

TEST_F(InterruptTest, KilledRunLeavesNoHalfFile) {
  EXPECT_EQ(interrupt("--policy " + calm_policy() + " --clock realtime", SIGKILL).code,
            128 + SIGKILL);
  EXPECT_EQ(files_in("results"), std::set<std::string>{});
}

TEST_F(InterruptTest, ClosedStandardOutputLosesNoResults) {
  EXPECT_EQ(interrupt("--policy " + calm_policy() + " --clock realtime", SIGINT, "", true).code, 3);
  EXPECT_EQ(summary("results").at("interrupted"), true);
  EXPECT_EQ(files_in("results").size(), 4u);
}

TEST_F(InterruptTest, FullDiskLeavesNoHalfFileAndNoneOfAnEarlierRun) {
  const std::string old_table = folder_.path("results/run.csv");
  std::filesystem::create_directory(folder_.path("results"));
  write_file(old_table, "of an earlier run");
  // As if the disk had room for 2 kB (4 blocks) a file.
  const Ended ended = interrupt("--policy " + calm_policy() + " --clock realtime", SIGINT,
                                "trap '' XFSZ && ulimit -f 4 && ");
  EXPECT_EQ(ended.code, 2);
  for (const std::string& name : files_in("results")) {
    EXPECT_EQ(name.find(".part"), std::string::npos) << name;
    EXPECT_NE(name, "run.csv");
  }
  // What became of the robot is reported all the same.
  EXPECT_NE(ended.out.find("interrupted, ended in damping"), std::string::npos) << ended.out;
}

}  // namespace
}  // namespace sandrunner
