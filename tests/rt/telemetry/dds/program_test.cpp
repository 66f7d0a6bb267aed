// SPDX-License-Identifier: BSD-3-Clause
// The program itself in real time, beside operators and good and bad subscribers, with recordings
// that replay bit for bit. Once before a release, longer and on a computer that does nothing else:
//   SANDRUNNER_RECORDINGS=20 SANDRUNNER_WATCHED_S=60 dds_program_test
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>

#include <cstdlib>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "rt/realtime/setup.h"
#include "rt/telemetry/recording/recording_file.h"
#include "tests/rt/support.h"
#include "tests/rt/telemetry/dds/support.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/unless_stalled.h"

namespace sandrunner {
namespace {

int from_environment(const char* name, int otherwise) {
  const char* const text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

/// Words of a command, from one line.
std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  return {std::istream_iterator<std::string>(in), {}};
}

std::string peer(const DdsConfig& config) {
  return SANDRUNNER_DDS_PEER " " + std::to_string(config.domain) + " lo ";
}

std::string program(const DdsConfig& config) {
  return SANDRUNNER_PROGRAM " --set dds.enabled=true --set dds.domain=" +
         std::to_string(config.domain) + " ";
}

void expect_replays_bit_for_bit(const std::string& recording) {
  ChildProcess replay({SANDRUNNER_REPLAY, recording});
  EXPECT_EQ(replay.wait().code, 0);
  EXPECT_NE(replay.wait().out.find("every bit agrees"), std::string::npos) << replay.wait();
}

/// Keeps a processor busy, one that the control thread does not use by default.
class BusyLoop {
 public:
  BusyLoop()
      : thread_([this] {
          const std::vector<int> cpus = allowed_cpus();
          cpu_set_t set;
          CPU_ZERO(&set);
          CPU_SET(cpus[cpus.size() > 1 ? cpus.size() - 2 : 0], &set);
          pthread_setaffinity_np(pthread_self(), sizeof set, &set);
          while (!end_.load(std::memory_order_relaxed)) {
          }
        }) {}
  ~BusyLoop() {
    end_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> end_{false};
  std::thread thread_;
};

/// Has a robot's run end with this object, and keeps what it then said.
class EndOfRun {
 public:
  EndOfRun(ChildProcess& robot, std::string& said) : robot_(robot), said_(said) {}
  ~EndOfRun() {
    robot_.signal(SIGTERM);
    said_ = robot_.wait().out;
  }
  EndOfRun(const EndOfRun&) = delete;
  EndOfRun& operator=(const EndOfRun&) = delete;

 private:
  ChildProcess& robot_;
  std::string& said_;
};

class DdsProgramTest : public testing::Test {
 protected:
  nlohmann::json summary(const std::string& folder) const {
    return nlohmann::json::parse(read_file(folder_.path(folder + "/summary.json")));
  }
  const TemporaryFolder folder_;
  const DdsConfig config_ = test_config();
};

TEST_F(DdsProgramTest, StateHashIsTheSameWithAndWithoutTelemetryAndRecording) {
  const auto hash = [&](const std::string& command, const std::string& more) {
    ChildProcess robot(words_of(command + " --start walk --duration 2 --command 0.8,0,0.2 --out " +
                                folder_.path("out") + more));
    EXPECT_EQ(robot.wait().code, 0);
    return summary("out").at("state_hash").get<std::string>();
  };
  const std::string without = hash(SANDRUNNER_PROGRAM, "");
  ChildProcess watcher(words_of(peer(config_) + "watch 60"));
  EXPECT_EQ(hash(program(config_), ""), without);
  EXPECT_EQ(hash(program(config_), " --record " + folder_.path("recording")), without);
  ASSERT_TRUE(watcher.wait_for("matched"));  // a reader listened
}

// An operator has the robot stand up, walk and stand again, or a fault ends the walk.
TEST_F(DdsProgramTest, RealTimeRecordingsUnderLoadReplayBitForBit) {
  const BusyLoop load;
  const int recordings = from_environment("SANDRUNNER_RECORDINGS", 3);
  const auto record = [&](int i, std::string& said) {
    const bool to_fault = i % 3 == 2;
    const DdsConfig config = test_config();
    const std::string dir = folder_.path(std::to_string(i));
    ChildProcess robot(
        words_of(program(config) + "--clock realtime --command dds --record " + dir + " --seed " +
                 std::to_string(i) +
                 // Legs that run are too fast for this, legs that stand up slowly are not.
                 (to_fault ? " --set controller.gate.speed_fault_radps=15"
                             " --set controller.stand.fold_s=1.5"
                           : " --set controller.stand.fold_s=0.4"
                             " --set controller.stand.extend_s=0.6")));
    const EndOfRun end(robot, said);
    const DdsParticipant participant(config, "operator");
    Peer operators(config);
    Asker asker(operators);
    const dds_entity_t twist = operators.writer("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc);
    for (const char* request :
         {"arm", "stand", "walk"}) {  // the process starts, and the robot stands up
      const auto asked = [&] {
        const sandrunner_ModeReply reply = asker.ask(request);
        // The answer before it may have come before the robot knew who hears it.
        return reply.accepted || std::string(reply.reason) == "the drives are on already";
      };
      ASSERT_TRUE(wait_until(asked, 30));
    }
    for (int step = 0; step < 75; ++step) {  // at 50 Hz
      drive(twist, 0.01 * step);
      sleep_s(0.02);
    }
    asker.ask("stop");
    const dds_entity_t ticks = operators.reader("sandrunner/ticks", sandrunner_TickBatch_desc);
    EXPECT_TRUE(wait_until([&] {
      auto mode = Mode::kPassive;
      take<sandrunner_TickBatch>(ticks, [&](const sandrunner_TickBatch& m) {
        mode = static_cast<Mode>(m.ticks._buffer[m.ticks._length - 1].mode);
      });
      return mode == (to_fault ? Mode::kFault : Mode::kStand);
    }));
    robot.signal(SIGTERM);
    robot.wait();
    EXPECT_NE(robot.wait().out.find(" in " + dir), std::string::npos) << robot.wait();
    EXPECT_EQ(robot.wait().out.find("LOST"), std::string::npos) << robot.wait();

    std::set<Mode> modes;
    std::uint64_t commands = 0, last_command = 0, skipped = 0;
    RecordingVisitor visitor;
    visitor.tick = [&](const TickRecord& tick) {
      modes.insert(tick.output.mode);
      skipped += tick.skipped;
      if (tick.input.command.tick != last_command) ++commands;
      last_command = tick.input.command.tick;
      return true;
    };
    const RecordingContents contents = read_recording(dir + "/run.mcap", visitor);
    EXPECT_TRUE(contents.complete);
    EXPECT_TRUE(modes.count(Mode::kStand) == 1 && modes.count(Mode::kWalk) == 1);
    EXPECT_EQ(modes.count(Mode::kFault), to_fault ? 1u : 0u);
    EXPECT_GT(commands, 40u);
    expect_replays_bit_for_bit(dir + "/run.mcap");
    std::printf("recording %d: %llu ticks, %llu skipped, %llu commands%s\n", i,
                static_cast<unsigned long long>(contents.ticks),
                static_cast<unsigned long long>(skipped), static_cast<unsigned long long>(commands),
                to_fault ? ", a fault" : "");
  };
  for (int i = 0; i < recordings; ++i) {
    SCOPED_TRACE(i);
    unless_stalled([&](std::string& said) { record(i, said); });
  }
}

// One subscriber listens, one is stopped for a while, one dies.
TEST_F(DdsProgramTest, BadSubscribersHoldUpNeitherControlNorRecordingNorAGoodOne) {
  const int watched_s = from_environment("SANDRUNNER_WATCHED_S", 4);
  const double stop_s = watched_s >= 20 ? 5.0 : 1.0;
  const auto walk = [&](const std::string& command, const std::string& out) {
    return words_of(command + " --clock realtime --start walk --command 0.5,0,0 --duration " +
                    std::to_string(watched_s) + " --out " + folder_.path(out));
  };
  unless_stalled([&](std::string& said) {
    const Ended alone = run_process(walk(SANDRUNNER_PROGRAM, "alone"));
    EXPECT_EQ(alone.code, 0) << alone;
    said = alone.out;
  });

  unless_stalled([&](std::string& said) {
    const std::string watch = peer(config_) + "watch " + std::to_string(watched_s + 2);
    ChildProcess live(words_of(watch)), stopped(words_of(watch)), killed(words_of(watch));
    for (ChildProcess* watcher : {&live, &stopped, &killed}) {
      ASSERT_TRUE(watcher->wait_for("watching"));
    }
    ChildProcess robot(walk(program(config_) + "--record " + folder_.path(""), "watched"));
    const EndOfRun end(robot, said);
    for (ChildProcess* watcher : {&live, &stopped, &killed}) {
      ASSERT_TRUE(watcher->wait_for("matched"));
    }
    stopped.signal(SIGSTOP);
    killed.signal(SIGKILL);
    sleep_s(stop_s);  // for as long it does not listen
    stopped.signal(SIGCONT);
    EXPECT_EQ(robot.wait().code, 0) << robot.wait();
    EXPECT_EQ(robot.wait().out.find("LOST"), std::string::npos) << robot.wait();
    EXPECT_EQ(number_after(live.wait().out, "gaps"), 0) << live.wait();
    EXPECT_EQ(number_after(live.wait().out, "lost_ticks"), 0) << live.wait();
    EXPECT_GT(number_after(live.wait().out, "batches"), 100 * watched_s - 100) << live.wait();
    if (stop_s < 2.0) {  // what kBatchDepth holds
      EXPECT_EQ(number_after(stopped.wait().out, "gaps"), 0) << stopped.wait();
    }
    std::printf("live: %sstopped: %s", live.wait().out.c_str(), stopped.wait().out.c_str());
  });

  const nlohmann::json before = summary("alone").at("realtime");
  const nlohmann::json now = summary("watched").at("realtime");
  EXPECT_EQ(now.at("records_dropped"), 0);
  const auto us = [](const nlohmann::json& j, const char* name, const char* quantile) {
    return j.at(name).at(quantile).get<double>();
  };
  const auto skipped = [](const nlohmann::json& j) { return j.at("ticks_skipped").get<double>(); };
  if (watched_s >= 20) {  // before a release; else other processes decide
    EXPECT_LE(skipped(now), skipped(before) + 0.02 * kControlHz * watched_s);
    EXPECT_LE(us(now, "late_us", "p50"), 2.0 * us(before, "late_us", "p50") + 20.0);
    EXPECT_LE(us(now, "control_us", "p50"), 2.0 * us(before, "control_us", "p50") + 5.0);
  }
  expect_replays_bit_for_bit(folder_.path("run.mcap"));
  for (const auto& [name, j] : {std::pair("alone", before), {"watched", now}}) {
    std::printf("%s: %s skipped, late p50 %.1f p99 %.1f, control step p50 %.2f p99 %.2f us\n", name,
                j.at("ticks_skipped").dump().c_str(), us(j, "late_us", "p50"),
                us(j, "late_us", "p99"), us(j, "control_us", "p50"), us(j, "control_us", "p99"));
  }
}

TEST_F(DdsProgramTest, ANetworkInterfaceThatGoesAwayIsNoticedByNeitherControlNorRecording) {
  // Without a map of users, the robot keeps the rights that real time needs.
  const std::string unshare = geteuid() == 0 ? "unshare --net" : "unshare --map-root-user --net";
  const std::string interface =
      "ip link set lo up && ip link add v0 type veth peer name v1 && "
      "ip addr add 10.9.8.7/24 dev v0 && ip link set v0 up && ip link set v1 up";
  if (run_shell(unshare + " sh -c '" + interface + "'").code != 0) {
    GTEST_SKIP() << "no network namespace with an interface of its own can be made here";
  }
  const std::string on_v0 = std::to_string(config_.domain) + " v0 ";
  write_file(folder_.path("script"),
             interface + "\n" + SANDRUNNER_DDS_PEER " " + on_v0 + "watch 60 >" +
                 folder_.path("log") + " & watcher=$!\n" + program(config_) +
                 "--set dds.interface=v0 --clock realtime --start walk --command 0.5,0,0 "
                 "--duration 3 --record " +
                 folder_.path("") + " --out " + folder_.path("out") +
                 " & robot=$!\nwhile kill -0 $robot && ! grep -q matched " + folder_.path("log") +
                 "; do sleep 0.02; done\nip link del v0\nwait $robot; code=$?\n"
                 "kill -9 $watcher; exit $code\n");
  unless_stalled([&](std::string& said) {
    const auto start = std::chrono::steady_clock::now();
    ChildProcess robot(words_of(unshare + " sh " + folder_.path("script")));
    said = robot.wait().out;
    EXPECT_EQ(robot.wait().code, 0) << robot.wait();
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
    EXPECT_EQ(robot.wait().out.find("LOST"), std::string::npos) << robot.wait();
  });
  EXPECT_EQ(summary("out").at("realtime").at("records_dropped"), 0);
  expect_replays_bit_for_bit(folder_.path("run.mcap"));
}

}  // namespace
}  // namespace sandrunner
