// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/black_box.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <limits>
#include <set>
#include <thread>

#include "rt/base/build.h"
#include "rt/core/processor.h"
#include "rt/loop/lockstep.h"
#include "rt/realtime/realtime_run.h"
#include "rt/telemetry/recording/recorder.h"
#include "sim/simulator.h"
#include "tests/rt/realtime/live_operator.h"
#include "tests/rt/support.h"
#include "tests/rt/telemetry/recording/recording_program.h"

namespace sandrunner {
namespace {

constexpr double kWindow_s = 2.0;

/// Walks in lockstep, with a black box that has a short window.
class BlackBoxTest : public RecordingProgramTest {
 protected:
  BlackBoxTest() {
    flush_denormals_to_zero();  // as in the programs
    info_.build = build_name();
    info_.start_mode = "walk";
    info_.clock = "lockstep";
    info_.config = config_.effective;
    info_.policy = shipped_policy_text();
    info_.robot_map = config_.robot.map;
    info_.robot = config_.robot.description;
    info_.start_time_ns = 1'700'000'000'000'000'000;
    command_.velocity.vx_mps = 1.0;
  }

  std::string dir() const { return std::filesystem::path(folder_.path("")).parent_path(); }
  void open(const std::string& folder) { open(folder, config_.controller, kWindow_s); }
  void open(const std::string& folder, const ControllerConfig& controller, double window_s,
            WhenFull when_full = WhenFull::kWait) {
    box_.emplace(folder, info_, window_s);
    ticks_.emplace(controller, Mode::kWalk, policy_, when_full, std::vector<TickKeeper*>{&*box_});
  }

  /// Walks on to tick `end`. In the ticks `faults` the command is not a number, which is a fault.
  void walk_to(std::uint64_t end, const std::set<std::uint64_t>& faults = {}) {
    for (std::uint64_t tick = loop_.next_tick(); tick < end; ++tick) {
      OperatorCommand command = command_;
      command.tick = tick;
      if (faults.contains(tick))
        command.velocity.wz_radps = std::numeric_limits<double>::quiet_NaN();
      loop_.tick(command);
      if (tick < lost_.first || tick >= lost_.second) ticks_->add(loop_.record());
    }
  }
  BlackBoxResult close() {
    ticks_->end();
    return box_->result();
  }
  void request(ModeRequest request) { command_.ask(request); }

  std::string path(std::uint64_t fault_tick) const {
    return folder_.path("black-box-" + std::to_string(fault_tick) + ".mcap");
  }
  /// Expects consecutive ticks in a file.
  RecordingContents read(const std::string& file, std::uint64_t& last_tick) const {
    std::uint64_t next = 0;
    bool first = true;
    RecordingContents contents = read_ticks(file, [&](const TickRecord& record) {
      if (first) next = record.input.sensors.tick;
      first = false;
      EXPECT_EQ(record.input.sensors.tick, next);
      ++next;
      return !HasFailure();
    });
    EXPECT_TRUE(contents.complete);
    EXPECT_EQ(contents.info.first_tick + contents.ticks, next);
    last_tick = next - 1;
    return contents;
  }
  void expect_one_line(const std::string& part) const {
    const std::string text = output();
    std::string last = text.substr(0, text.size() - 1);
    if (last.rfind("wrote", 0) == 0) last = last.substr(last.find('\n') + 1);
    EXPECT_EQ(last.find('\n'), std::string::npos) << text;
    EXPECT_NE(last.find(part), std::string::npos) << text;
  }

  const PolicyRunner policy_{load_shipped_policy()};
  const ProcessConfig config_ = config_of(
      "dry-sand", {"sim.noise.joint_position_rad=0.005", "controller.damping.fault_s=0.5"},
      policy_.spec());
  RecordingInfo info_;
  OperatorCommand command_;
  std::pair<std::uint64_t, std::uint64_t> lost_{};  ///< from, to: the black box does not get these
  std::optional<BlackBox> box_;
  std::optional<ReplayedTicks> ticks_;

 private:
  sim::Simulator simulator_{config_.robot, config_.simulator};
  PolicyRunner walking_ = policy_;
  Lockstep loop_{simulator_, config_.controller, Mode::kWalk, walking_};
};

TEST_F(BlackBoxTest, HoldsTheWindowBeforeTheFaultAndTheLetDownAndReplaysFromItsState) {
  open(dir());
  walk_to(32000, {20000});
  // Written 2 s after the fault, while the run goes on.
  for (int i = 0; i < 1000 && !std::filesystem::exists(path(20000)); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_TRUE(std::filesystem::exists(path(20000)));
  const BlackBoxResult result = close();
  EXPECT_FALSE(ticks_->result().difference) << ticks_->result().difference->what;
  EXPECT_EQ(ticks_->result().dropped, 0u);
  ASSERT_EQ(result.files.size(), 1u);
  const BlackBoxFile& file = result.files[0];
  EXPECT_EQ(file.path, path(20000));
  EXPECT_EQ(file.problem, "");
  EXPECT_TRUE(file.has_start);
  EXPECT_EQ(file.fault, Fault::kNonFiniteCommand);
  EXPECT_EQ(file.fault_tick, 20000u);
  EXPECT_GE(file.before_s, kWindow_s - 0.001);
  EXPECT_LE(file.before_s, kWindow_s + 0.2);
  EXPECT_EQ(folder_.number_of_files(), 1u) << "no part of a file is left";

  std::uint64_t last = 0;
  const RecordingContents contents = read(path(20000), last);
  EXPECT_GE(last, 28000u);
  EXPECT_LE(last, 28400u);
  EXPECT_FALSE(contents.info.state.empty());
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(20000)), 0) << output();
  expect_one_line(std::to_string(contents.ticks) + " ticks and ");
}

TEST_F(BlackBoxTest, FlippedBitOfAnInputIsFoundAndNamed) {
  open(dir());
  walk_to(24000, {20000});
  ticks_->end();
  flip(path(20000), folder_.path("flipped.mcap"), 18000, word_named("joint_position_rad[7]"), 1);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, folder_.path("flipped.mcap")), 1);
  expect_one_line("DIFFERS at tick 18000 (4.50000 s): released_joint_position_rad[7]");
}

TEST_F(BlackBoxTest, FlippedBitOfTheStateIsFoundAtTheFirstTickThatItChanges) {
  open(dir());
  walk_to(24000, {20000});
  ticks_->end();
  const auto spoil = [](RecordingInfo& info) {
    ReplayState state = read_replay_state(info.state, "state");
    state.controller.target_rad[4] += 1e-9;
    info.state = replay_state_bytes(state);
  };
  rewrite(path(20000), folder_.path("spoilt.mcap"), spoil, {});
  EXPECT_EQ(run(SANDRUNNER_REPLAY, folder_.path("spoilt.mcap")), 1);
  expect_one_line("command_position_rad[4]: recorded");
}

TEST_F(BlackBoxTest, RangePageAndOtherSettingsWorkFromTheMiddle) {
  open(dir());
  walk_to(24000, {20000});
  ticks_->end();
  const std::string plots = "--plot '" + folder_.path("plots") + "' ";
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(20000) + " --from 4 --to 4.5 " + plots), 0) << output();
  EXPECT_NE(output().find("2001 ticks"), std::string::npos) << output();
  const std::string csv = read_file(folder_.path("plots/run.csv"));
  EXPECT_EQ(csv.substr(csv.find('\n') + 1, 7), "4,walk,");
  EXPECT_TRUE(std::filesystem::exists(folder_.path("plots/run.html")));
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(20000) + " --set controller.walk.kd_nmsprad=0.6"), 1);
  std::uint64_t last = 0;
  const std::uint64_t first = read(path(20000), last).info.first_tick;
  expect_one_line("DIFFERS at tick " + std::to_string(first) + " ");
}

TEST_F(BlackBoxTest, FaultInTheFirstSecondHasTheWholeRun) {
  open(dir());
  walk_to(3990, {1000});
  EXPECT_EQ(close().files.size(), 1u);
  std::uint64_t last = 0;
  const RecordingContents contents = read(path(1000), last);
  EXPECT_EQ(contents.info.first_tick, 0u);
  EXPECT_EQ(contents.info.state, "");
  EXPECT_EQ(last, 3989u);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(1000)), 0) << output();
}

TEST_F(BlackBoxTest, EachFaultHasItsFile) {
  open(dir());
  walk_to(12000, {8000});
  request(ModeRequest::kResetFault);
  walk_to(12400);
  request(ModeRequest::kStand);
  walk_to(30000, {28000});
  const BlackBoxResult result = close();
  ASSERT_EQ(result.files.size(), 2u);
  EXPECT_FALSE(ticks_->result().difference);
  std::uint64_t last = 0;
  read(path(8000), last);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(8000)), 0) << output();
  read(path(28000), last);
  EXPECT_EQ(last, 29999u);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(28000)), 0) << output();
}

TEST_F(BlackBoxTest, RunHasTenFilesAtMost) {
  open(dir());
  for (std::uint64_t fault = 1; fault <= 12; ++fault) {
    walk_to(fault * 2200 + 2100, {fault * 2200});  // the drives are on for 0.5 s after a fault
    request(ModeRequest::kResetFault);
  }
  walk_to(29000);
  const BlackBoxResult result = close();
  EXPECT_EQ(result.files.size(), 10u);
  EXPECT_EQ(result.left_out, 2u);
  EXPECT_EQ(folder_.number_of_files(), 10u);
}

TEST_F(BlackBoxTest, RunWithoutAFaultHasNoFileAndIsVerified) {
  open(dir());
  walk_to(28000);
  const BlackBoxResult result = close();
  EXPECT_TRUE(result.files.empty());
  EXPECT_FALSE(ticks_->result().difference) << ticks_->result().difference->what;
  EXPECT_EQ(folder_.number_of_files(), 0u);
  // The window, what follows a fault, and a block: 4.1 s of 11.7 MB/s, compressed to 28 %.
  EXPECT_GT(result.peak_bytes, 4.0 * 1e6);
  EXPECT_LT(result.peak_bytes, 4.1 * 3.5e6);
}

TEST_F(BlackBoxTest, ARecordingThatStopsDoesNotStopTheBlackBoxBehindTheSameQueue) {
  Recorder recorder(folder_.path("run.mcap"), info_, {.bytes = 1});
  box_.emplace(dir(), info_, kWindow_s);
  ticks_.emplace(config_.controller, Mode::kWalk, policy_, WhenFull::kWait,
                 std::vector<TickKeeper*>{&recorder, &*box_});
  walk_to(24000, {20000});
  const BlackBoxResult result = close();
  EXPECT_EQ(recorder.result().stopped_because, "its size reached the limit");
  EXPECT_EQ(result.files.at(0).problem, "");
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(20000)), 0) << output();
  EXPECT_EQ(run(SANDRUNNER_REPLAY, folder_.path("run.mcap")), 0) << output();
}

TEST_F(BlackBoxTest, RunThatDoesNotReplayIsReported) {
  ProcessConfig other = config_of("dry-sand", {"controller.walk.kd_nmsprad=0.6"}, policy_.spec());
  open(dir(), other.controller, kWindow_s);
  walk_to(24000);
  const BlackBoxResult result = close();
  ASSERT_TRUE(ticks_->result().difference);
  EXPECT_EQ(ticks_->result().difference->tick, 0u);
  EXPECT_EQ(ticks_->result().difference->what.substr(0, 21), "command_kd_nmsprad[0]");
}

TEST_F(BlackBoxTest, TicksLostBeforeTheWindowLeaveAFileThatCannotBeReplayed) {
  lost_ = {5000, 5040};
  open(dir());
  walk_to(24000, {20000});
  const BlackBoxResult result = close();
  EXPECT_FALSE(ticks_->result().difference) << ticks_->result().difference->what;
  EXPECT_EQ(ticks_->result().lost_from, 5000u);
  ASSERT_EQ(result.files.size(), 1u);
  EXPECT_FALSE(result.files[0].has_start);
  std::uint64_t last = 0;
  const RecordingContents contents = read(path(20000), last);
  EXPECT_GT(contents.info.first_tick, 5040u);
  EXPECT_EQ(contents.info.state, "");
  EXPECT_EQ(last, 23999u);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(20000)), 2);
  expect_one_line("it cannot be replayed");
  // Its page can still be made.
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(20000) + " --plot '" + folder_.path("plots") + "'"), 2);
  EXPECT_TRUE(std::filesystem::exists(folder_.path("plots/run.html")));
}

TEST_F(BlackBoxTest, TicksLostWithinTheWindowAreReportedAsLostAndNotAsADifference) {
  lost_ = {18000, 18040};
  open(dir());
  walk_to(24000, {20000});
  const BlackBoxResult result = close();
  EXPECT_FALSE(ticks_->result().difference) << ticks_->result().difference->what;
  EXPECT_EQ(ticks_->result().lost_from, 18000u);
  EXPECT_TRUE(result.files.at(0).has_start);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(20000)), 2);
  std::uint64_t first = 0;
  read_ticks(path(20000), [&](const TickRecord& tick) {
    first = tick.input.sensors.tick;
    return false;
  });
  EXPECT_EQ(output(), "LOST while recording: tick 18000 (4.50000 s) to 18039 (4.50975 s)\n" +
                          std::to_string(18000 - first) + " ticks and " +
                          std::to_string((18000 - first) / kTicksPerPolicyStep) +
                          " policy steps compared: every bit agrees\n"
                          "5960 ticks behind lost ones have no state to start from: NOT COMPARED\n"
                          "sandrunner-replay: " +
                          path(20000) +
                          ": up to 40 ticks were lost while recording, they are not compared\n");
}

TEST_F(BlackBoxTest, BatchesLostOnTheWayLeaveNoStateBehindThem) {
  lost_ = {8000, 12000};  // blocks as they are dropped when the queue is full
  open(dir());
  walk_to(28000, {20000});
  const BlackBoxResult result = close();
  EXPECT_FALSE(ticks_->result().difference) << ticks_->result().difference->what;
  EXPECT_EQ(ticks_->result().lost_from, 8000u);
  EXPECT_FALSE(result.files.at(0).has_start);
  EXPECT_EQ(read_ticks(path(20000)).info.first_tick, 12000u);
}

TEST_F(BlackBoxTest, FirstTickThatTheFileDoesNotBeginWithIsRefused) {
  open(dir());
  walk_to(24000, {20000});
  ticks_->end();
  for (const std::uint64_t wrong : {std::uint64_t{0}, std::uint64_t{40}, ~std::uint64_t{0}}) {
    rewrite(path(20000), folder_.path("wrong.mcap"),
            [&](RecordingInfo& info) { info.first_tick = wrong; }, {});
    EXPECT_EQ(run(SANDRUNNER_REPLAY, folder_.path("wrong.mcap")), 2) << output();
    expect_one_line("first_tick is " + std::to_string(wrong) + ", but the first tick is ");
  }
}

TEST_F(BlackBoxTest, FileThatCannotBeWrittenIsReportedAndTheBlackBoxGoesOn) {
  // A folder of the file's name: however late the writer comes, it is in the way.
  std::filesystem::create_directories(path(2000) + "/in-the-way");
  open(dir());
  walk_to(12000, {2000});
  request(ModeRequest::kResetFault);
  walk_to(24000, {20000});
  const BlackBoxResult result = close();
  ASSERT_EQ(result.files.size(), 2u);
  EXPECT_NE(result.files[0].problem.find(path(2000)), std::string::npos) << result.files[0].problem;
  EXPECT_EQ(result.files[0].problem.find('\n'), std::string::npos);
  EXPECT_EQ(result.files[1].problem, "");
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path(20000)), 0) << output();
}

TEST_F(BlackBoxTest, FolderThatCannotBeWrittenIsReported) {
  open(folder_.path("absent"));
  walk_to(12000, {2000});
  const BlackBoxResult result = close();
  ASSERT_EQ(result.files.size(), 1u);
  EXPECT_NE(result.files[0].problem.find("absent/black-box-2000.mcap"), std::string::npos);
  EXPECT_EQ(result.files[0].problem.find('\n'), std::string::npos);
}

TEST_F(BlackBoxTest, DamagedStateIsBadInput) {
  open(dir());
  walk_to(24000, {20000});
  ticks_->end();
  const std::string spoilt = folder_.path("spoilt.mcap");
  const auto refused = [&](const std::function<void(std::string&)>& spoil, const char* why) {
    rewrite(path(20000), spoilt, [&](RecordingInfo& info) { spoil(info.state); }, {});
    EXPECT_EQ(run(SANDRUNNER_REPLAY, spoilt), 2) << output();
    expect_one_line(spoilt + ": attachment 'state.bin': ");
    EXPECT_NE(output().find(why), std::string::npos) << output();
  };
  refused([](std::string& state) { state.resize(100); }, "100 bytes");
  refused([](std::string& state) { state.resize(9); }, "9 bytes");
  refused([](std::string& state) { state += "more"; }, "expected");
  refused([](std::string& state) { state[0] = 'X'; }, "SRSTATE1");
  refused([](std::string& state) { state[8] = static_cast<char>(state[8] ^ 8); }, "announce");
  refused([](std::string& state) { state[16] = 77; }, "mode 77");
}

TEST_F(BlackBoxTest, DamagedChunkCostsItsOwnSpanOnly) {
  open(dir());
  walk_to(24000, {20000});
  ticks_->end();
  constexpr std::uint64_t kBlock = 400;  // states are known where blocks begin
  expect_damage_costs_its_own_span(path(20000), read_ticks(path(20000)).ticks, kBlock);
}

// With two threads, answers come late, so that at any tick the policy may still be at work.
TEST_F(BlackBoxTest, ThreadedRunReplaysFromTheMiddle) {
  open(dir(), config_.controller, 0.3, WhenFull::kDrop);
  LiveOperator op;
  op.want(VelocityCommand{.vx_mps = 1.0});
  CallingSink sink;
  sink.at_tick = [&](const TickRecord&) {
    if (op.time_s() > 3.0 && op.mode() != Mode::kFault) {
      op.want(VelocityCommand{.vx_mps = std::numeric_limits<double>::quiet_NaN()});
    }
    if (op.time_s() > 3.2) op.end();
  };
  sim::Simulator simulator(config_.robot, config_.simulator);
  PolicyRunner policy = policy_;
  SystemClock clock;
  run_realtime({.robot = simulator,
                .controller = config_.controller,
                .start = Mode::kWalk,
                .policy = policy,
                .op = op,
                .sinks = {&*ticks_, &sink}},
               config_.realtime, clock);
  const BlackBoxResult result = close();
  EXPECT_FALSE(ticks_->result().difference) << ticks_->result().difference->what;
  ASSERT_EQ(result.files.size(), 1u);
  EXPECT_GT(read_ticks(result.files[0].path).info.first_tick, 0u);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, result.files[0].path), 0) << output();
}

class BlackBoxOfTheProgram : public BlackBoxTest {
 protected:
  // The body of a walking robot soon tilts by more than that.
  static constexpr const char* kRun =
      "--clock realtime --start walk --duration 3 --set controller.gate.tilt_fault_deg=1.5 ";

  /// The only black box in the folder.
  std::string found() const {
    std::string path;
    for (const auto& entry : std::filesystem::directory_iterator(dir())) {
      const std::string name = entry.path().filename().string();
      if (name.rfind("black-box-", 0) == 0) path = entry.path().string();
    }
    return path;
  }
};

TEST_F(BlackBoxOfTheProgram, RealtimeRunWithAFaultLeavesARecordingThatReplays) {
  EXPECT_EQ(run(SANDRUNNER_PROGRAM, kRun + ("--record '" + dir() + "'")), 1);
  ASSERT_NE(found(), "") << output();
  EXPECT_NE(output().find("s before the fault '"), std::string::npos) << output();
  EXPECT_NE(output().find(", in " + dir() + "/black-box-"), std::string::npos) << output();
  EXPECT_EQ(run(SANDRUNNER_REPLAY, found()), 0) << output();
}

TEST_F(BlackBoxOfTheProgram, GoesToTheFolderOfTheOtherFilesElseToTheWorkingFolder) {
  EXPECT_EQ(run(SANDRUNNER_PROGRAM, kRun + ("--out '" + folder_.path("out") + "'")), 1);
  EXPECT_NE(output().find(folder_.path("out") + "/black-box-"), std::string::npos) << output();
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(dir());
  EXPECT_EQ(run(SANDRUNNER_PROGRAM, kRun), 1);
  std::filesystem::current_path(before);
  EXPECT_NE(found(), "") << output();
}

TEST_F(BlackBoxOfTheProgram, LockstepRunWritesNoBlackBox) {
  EXPECT_EQ(run(SANDRUNNER_PROGRAM,
                "--start walk --duration 1 --set controller.gate.tilt_fault_deg=1.5 --record '" +
                    folder_.path("") + "'"),
            1);
  EXPECT_EQ(found(), "");
}

TEST_F(BlackBoxOfTheProgram, FullDiskIsReportedAndChangesNothingElse) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(dir());
  EXPECT_EQ(run_on_full_disk(SANDRUNNER_PROGRAM, kRun), 1);
  std::filesystem::current_path(before);
  EXPECT_NE(output().find("NOT WRITTEN: ./black-box-"), std::string::npos) << output();
  EXPECT_EQ(folder_.number_of_files(), 0u) << "no part of a file is left";
}

}  // namespace
}  // namespace sandrunner
