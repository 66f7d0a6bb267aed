// SPDX-License-Identifier: BSD-3-Clause
// What a page does to a simulated robot and its ground, over a real socket.
#include "rt/telemetry/view/view_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "rt/loop/replay.h"
#include "rt/operator/operator_desk.h"
#include "rt/run/simulator_control.h"
#include "rt/telemetry/recording/recorder.h"
#include "rt/telemetry/recording/recording_file.h"
#include "rt/telemetry/view/view_server.h"
#include "tests/rt/support.h"
#include "tests/rt/telemetry/view/web_page.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kSecond = kControlHz;
constexpr const char* kSoft =
    R"({"say":"terrain","preset":"","set":{"sigma_flat_npm3":2500000,"sigma_cone_npm3":150000}})";
constexpr const char* kPushLeft = R"({"say":"push","direction":1.5707963267948966})";

/// A run in lockstep with a page that has the key.
struct ViewControlTest : testing::Test, TickSink, BetweenTicks {
  ViewControlTest() {
    const std::string url = server->url();
    page.emplace(std::stoi(url.substr(url.find(':', 6) + 1)));
    page->say(R"({"say":"hello","key":")" + url.substr(url.find("#key=") + 5) + "\"}");
    page->hear("hello");
  }

  /// Says it and waits until the server has seen to it; returns the refusal, empty: none.
  std::string say(std::string_view text) {
    page->say(text);
    page->say(R"({"say":"hello","key":""})");  // which is refused: said once already
    std::string refusal = page->hear("refused").at("why");
    if (refusal == "hello was said") return {};
    page->hear("refused");
    return refusal;
  }

  void add(const TickRecord& tick) override { ticks.push_back(tick); }
  void note(std::uint64_t tick, const std::string& kind, const std::string& text) override {
    notes.push_back(std::to_string(tick) + " " + kind + ": " + text);
  }
  RobotNow act(std::uint64_t next, TickSinks sinks) override {
    if (before_tick) before_tick(next);
    return control->act(next, sinks);
  }

  /// Walks for this long; `before` may say something before a tick.
  RunResult walk(double seconds, const std::function<void(std::uint64_t)>& before,
                 OperatorInput* live = nullptr) {
    before_tick = before;
    const CommandSource command("1,0,0");
    std::vector<TickSink*> sinks = {this};
    if (recorded) sinks.push_back(&*recorded);
    RunScript script(command, {.walk_s = seconds, .start_walking = true}, true);
    RunResult result = run_in_lockstep({.robot = simulator,
                                        .controller = config.controller,
                                        .start = live ? Mode::kPassive : Mode::kWalk,
                                        .policy = policy,
                                        .op = live ? *live : script,
                                        .sinks = sinks,
                                        .between = this,
                                        .interrupts = interrupt},
                                       {});
    if (!live) script.report(result);
    return result;
  }

  /// Mean depth of the feet that touch the ground, m, from one tick to another.
  double sinkage_m(std::uint64_t from, std::uint64_t to) const {
    double sum = 0.0;
    int count = 0;
    for (std::uint64_t i = from; i < to; ++i) {
      for (const double depth : ticks[i].truth.foot_penetration_m) {
        if (depth < 0.0) continue;
        sum += depth;
        ++count;
      }
    }
    return sum / count;
  }

  PolicyRunner policy{load_shipped_policy()};
  const ProcessConfig config = config_of("wet-sand", {}, policy.spec());
  sim::Simulator simulator{config.robot, config.simulator};
  RemoteOperator remote{1200};
  ReturnToStand return_to_stand{remote};
  std::optional<SimulatorControl> control{std::in_place, simulator, config.simulator.terrain,
                                          config.effective, &return_to_stand};
  ViewFeed feed{RunScene{.robot = config.robot.description}};
  std::optional<ViewServer> server{std::in_place, 0,
                                   ViewServer::Parts{.feed = feed, .control = &*control}};
  std::optional<WebPage> page;
  std::atomic<int> interrupt{false};
  std::optional<Recorder> recorder;
  std::optional<ReplayedTicks> recorded;
  std::vector<TickRecord> ticks;
  std::vector<std::string> notes;
  std::function<void(std::uint64_t)> before_tick;
};

TEST_F(ViewControlTest, AQuarterOfTheStiffnessLetsTheFeetSinkDeeperAndTheRecordingReplays) {
  const TemporaryFolder folder;
  RecordingInfo info;
  info.start_mode = "walk";
  info.clock = "lockstep";
  recorder.emplace(folder.path("run.mcap"), info, RecordingLimits{});
  recorded.emplace(config.controller, Mode::kWalk, policy, WhenFull::kWait,
                   std::vector<TickKeeper*>{&*recorder});
  const RunResult result = walk(4.0, [&](std::uint64_t next) {
    if (next == 2 * kSecond) {
      EXPECT_EQ(say(kSoft), "");
    }
  });
  EXPECT_TRUE(result.survived) << result.fall_reason;
  ASSERT_EQ(ticks.size(), 4 * kSecond);
  const double before_m = sinkage_m(kSecond, 2 * kSecond);
  const double after_m = sinkage_m(2 * kSecond, 4 * kSecond);
  EXPECT_GT(after_m, 1.3 * before_m);
  RecordProperty("before_mm", std::to_string(1e3 * before_m));
  RecordProperty("after_mm", std::to_string(1e3 * after_m));

  Replay replay(config.controller, Mode::kWalk, policy);
  std::vector<std::string> events;
  RecordingVisitor visitor;
  visitor.tick = [&](const TickRecord& tick) {
    const std::optional<ReplayDifference> difference = replay.check(tick);
    if (difference) ADD_FAILURE() << difference->tick << ": " << difference->what;
    return !difference;
  };
  visitor.event = [&](std::uint64_t tick, const std::string& kind, const std::string& text) {
    if (kind == "terrain") events.push_back(std::to_string(tick) + " " + text);
  };
  read_recording(folder.path("run.mcap"), visitor);
  EXPECT_EQ(replay.ticks(), ticks.size());
  EXPECT_EQ(events, std::vector<std::string>{
                        "8000 as the run began sigma_cone_npm3=150000 sigma_flat_npm3=2500000"});
}

TEST_F(ViewControlTest, ARunThatNobodyTouchesIsTheSameToTheBit) {
  const RunResult plain = run_once(config, policy, {.walk_s = 1.0, .start_walking = true});
  EXPECT_EQ(walk(1.0, {}).end.state_hash, plain.end.state_hash);
  EXPECT_TRUE(notes.empty());
}

TEST_F(ViewControlTest, APushIsHalfAMetrePerSecondBetweenTwoTicksAndTheNextTickKnowsOfIt) {
  double before_mps = 0.0, after_mps = 0.0;
  walk(1.0, [&](std::uint64_t next) {
    if (next == 1000) {
      before_mps = simulator.state().robot.rigid.velocity.y;
      EXPECT_EQ(say(kPushLeft), "");
    }
  });
  after_mps = ticks[1000].truth.velocity_mps[1];
  EXPECT_NEAR(after_mps - before_mps, kPush_mps, 0.1);
  EXPECT_NEAR(ticks[1000].before.state.velocity_mps[1] - ticks[999].before.state.velocity_mps[1],
              kPush_mps, 0.1);
  EXPECT_EQ(notes, std::vector<std::string>{"1000 push: 0.5 m/s towards 90 degrees"});
}

TEST_F(ViewControlTest, ARobotThatHasFallenWithAFaultStandsAgainByTheWaysOfTheModeMachine) {
  OperatorDesk desk(remote, 60.0, nullptr);
  bool fallen = false;
  std::vector<Mode> modes;
  simulator.reset_lying();
  const RunResult result = walk(
      0.0,
      [&](std::uint64_t next) {
        const TickRecord& last = ticks.back();
        if (modes.empty() || modes.back() != last.output.mode) modes.push_back(last.output.mode);
        if (next == 10) {
          EXPECT_EQ(say(R"({"say":"set_on_legs"})"), "");
        }
        if (last.output.mode == Mode::kStand && !fallen && last.output.faults == 0) {
          for (int i = 0; i < 12; ++i) EXPECT_EQ(say(kPushLeft), "");
          fallen = true;
        }
        if (last.output.mode == Mode::kFault && modes[modes.size() - 2] == Mode::kStand &&
            notes.back().find("push") != std::string::npos) {
          EXPECT_EQ(say(R"({"say":"set_on_legs"})"), "");
        }
        const bool stands = fallen && last.output.mode == Mode::kStand && last.output.faults == 0 &&
                            modes.size() > 5;
        if (stands || next > 40 * kSecond) interrupt = true;
      },
      &return_to_stand);
  using enum Mode;
  EXPECT_EQ(modes, (std::vector<Mode>{kPassive, kDamping, kStandUp, kStand, kFault, kPassive,
                                      kDamping, kStandUp, kStand, kDamping}));
  const auto& [w, x, y, z] = ticks[ticks.size() - kDampingEnd_ticks].truth.orientation_wxyz;
  EXPECT_GT(1.0 - 2.0 * (x * x + y * y), 0.98);
  EXPECT_EQ(result.end.gate.faults, 0u);
}

TEST_F(ViewControlTest, GroundOfAnotherKindThrowsNobodyUp) {
  const std::vector<std::string> presets = sim::terrain_preset_names();
  std::size_t changes = 0;
  const RunResult result = walk(7.0, [&](std::uint64_t next) {
    if (next % kSecond != 0) return;
    const std::string& preset = presets[changes++ % presets.size()];
    EXPECT_EQ(say(R"({"say":"terrain","preset":")" + preset + R"(","set":{}})"), "");
    EXPECT_EQ(control->ground().name, preset);
  });
  EXPECT_TRUE(result.survived) << result.fall_reason;
  EXPECT_EQ(changes, 6u);
  const auto height_m = [](const TickRecord& t) { return t.truth.position_m[2]; };
  EXPECT_LT(height_m(std::ranges::max(ticks, {}, height_m)), 0.6);
}

TEST_F(ViewControlTest, WhatSetRefusesIsRefusedInTheSameWords) {
  EXPECT_EQ(say(R"({"say":"terrain","preset":"","set":{"friction":9}})"),
            "page: terrain.friction: found 9, expected a finite number from 0 to 5");
  EXPECT_EQ(say(R"({"say":"terrain","preset":"","set":{"packing":-1}})"),
            "page: terrain.packing: found -1, expected a finite number from 0 to 1");
  EXPECT_EQ(say(R"({"say":"terrain","preset":"","set":{"roughness_m":0.1}})"),
            "terrain: 'roughness_m', expected one of sigma_flat_npm3, sigma_cone_npm3, "
            "stiffness_npm, friction, drag, packing, strength_pa, suction");
  EXPECT_EQ(say(R"({"say":"terrain","preset":"/etc/passwd","set":{}})"),
            "terrain: '/etc/passwd', expected one of air-mattress, athletic-track, dry-on-wet, "
            "dry-sand, grass, memory-foam, mud, rigid, sand-on-rock, swamp, turf, vinyl, wet-sand");
  EXPECT_EQ(control->ground().wanted.set.size(), 0u);
}

TEST_F(ViewControlTest, WhoHasNoKeyAndARobotThatCannotBeTouchedAreRefusedInWords) {
  const auto refusal = [](const ViewServer& of, bool with_key) {
    const std::string url = of.url();
    WebPage other(std::stoi(url.substr(url.find(':', 6) + 1)));
    other.say(R"({"say":"hello","key":")" +
              (with_key ? url.substr(url.find("#key=") + 5) : std::string()) + "\"}");
    other.say(kSoft);
    return other.hear("refused").at("why").get<std::string>();
  };
  EXPECT_EQ(refusal(*server, false), "without the key this page only looks");
  const ViewServer real(0, {.feed = feed});
  EXPECT_EQ(refusal(real, true),
            "only a simulated robot in lockstep can be touched, and its ground changed");
  SimulatorControl scripted(simulator, config.simulator.terrain, config.effective, nullptr);
  EXPECT_EQ(scripted.set_on_legs(),
            "this run follows its command line: only with --command live is the robot set on its "
            "legs");
}

}  // namespace
}  // namespace sandrunner
