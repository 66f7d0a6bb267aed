// SPDX-License-Identifier: BSD-3-Clause
#include "rt/loop/replay.h"

#include <gtest/gtest.h>

#include "rt/loop/tick_fields.h"
#include "tests/policy/random_perceptron.h"
#include "tests/rt/support.h"
#include "tests/support/unless_stalled.h"

namespace sandrunner {
namespace {

/// Ticks of a run of the policy that ships, from lying through a short walk.
std::vector<TickRecord> recorded_run(const ProcessConfig& config, bool realtime) {
  std::vector<TickRecord> ticks;
  unless_stalled([&](std::string& said) {
    ticks.clear();
    said = simulate({.config = config,
                     .policy = PolicyRunner(load_shipped_policy()),
                     .command = "1,0,0.5",
                     .plan = {.walk_s = 1.0, .start_walking = realtime},
                     .at_tick = [&](const TickRecord& tick) { ticks.push_back(tick); },
                     .realtime = realtime})
               .fall_reason;
    EXPECT_FALSE(stalled(said)) << said;
  });
  return ticks;
}

ProcessConfig noisy_config(const std::vector<std::string>& more = {}) {
  std::vector<std::string> settings = {"sim.noise.joint_position_rad=0.01",
                                       "sim.noise.angular_velocity_radps=0.05"};
  settings.insert(settings.end(), more.begin(), more.end());
  const PolicyRunner policy(load_shipped_policy());
  return config_of("dry-sand", settings, policy.spec());
}

std::optional<ReplayDifference> replay(const std::vector<TickRecord>& ticks,
                                       const ProcessConfig& config, Mode start) {
  Replay replay(config.controller, start, PolicyRunner(load_shipped_policy()));
  for (const TickRecord& tick : ticks) {
    if (auto difference = replay.check(tick)) return difference;
  }
  EXPECT_EQ(replay.ticks(), ticks.size());
  EXPECT_GT(replay.policy_steps(), 90u);
  return std::nullopt;
}

class ReplayTest : public testing::Test {
 protected:
  static const std::vector<TickRecord>& ticks() {
    static const std::vector<TickRecord> kTicks = recorded_run(noisy_config(), false);
    return kTicks;
  }
};

TEST_F(ReplayTest, LockstepRunReplaysBitForBit) {
  const auto difference = replay(ticks(), noisy_config(), Mode::kPassive);
  EXPECT_FALSE(difference) << difference->what;
}

TEST_F(ReplayTest, ThreadedRunReplaysBitForBit) {
  const ProcessConfig config = noisy_config();
  const auto difference = replay(recorded_run(config, true), config, Mode::kWalk);
  EXPECT_FALSE(difference) << difference->tick << ": " << difference->what;
}

TEST_F(ReplayTest, FlippedInputBitIsFoundByWhatItChanges) {
  // Words whose every bit decides something while the robot walks.
  const std::size_t at = 20000;
  ASSERT_EQ(ticks()[at].output.mode, Mode::kWalk);
  const auto word_of = [](const std::string& name) {
    std::size_t word = 0;
    while (tick_word_name(word) != name) ++word;
    return word;
  };
  for (const char* name :
       {"joint_position_rad[2]", "joint_velocity_radps[1]", "imu_orientation_wxyz[1]",
        "policy_target_rad[3]", "policy_sequence", "command_kp_nmprad[5]"}) {
    const std::size_t word = word_of(name);
    std::vector<TickRecord> spoilt(ticks().begin(), ticks().end());
    auto words = std::bit_cast<TickWords>(spoilt[at]);
    words[word] ^= 1;
    spoilt[at] = std::bit_cast<TickRecord>(words);
    const auto difference = replay(spoilt, noisy_config(), Mode::kPassive);
    ASSERT_TRUE(difference) << tick_word_name(word);
    EXPECT_GE(difference->tick, at);
    EXPECT_LE(difference->tick, at + 80) << tick_word_name(word) << " -> " << difference->what;
  }
}

TEST_F(ReplayTest, FlippedOutputBitIsNamedInItsTick) {
  std::vector<TickRecord> spoilt(ticks().begin(), ticks().end());
  spoilt[100].output.faults ^= 1;
  const auto difference = replay(spoilt, noisy_config(), Mode::kPassive);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->tick, 100u);
  EXPECT_EQ(difference->what, "faults: recorded 1, computed 0");
}

TEST_F(ReplayTest, AnotherGainIsFoundInTheFirstTickThatUsesIt) {
  const ProcessConfig other = noisy_config({"controller.walk.kp_nmprad=51"});
  const auto difference = replay(ticks(), other, Mode::kPassive);
  ASSERT_TRUE(difference);
  const auto first_walk = std::find_if(ticks().begin(), ticks().end(), [](const TickRecord& tick) {
    return tick.output.mode == Mode::kWalk;
  });
  EXPECT_EQ(difference->tick, first_walk->input.sensors.tick);
  EXPECT_EQ(difference->what.substr(0, 20), "command_kp_nmprad[0]") << difference->what;
}

// Between the tick that releases the policy and the one that brings its answer, too.
TEST_F(ReplayTest, ContinuesFromTheStateOfAnotherReplay) {
  const auto released = std::find_if(ticks().begin() + 12000, ticks().end(), [](const auto& tick) {
    return tick.output.release_policy != 0;
  });
  for (auto from = released - 1; from < released + 3; ++from) {
    const PolicyRunner policy(load_shipped_policy());
    Replay first(noisy_config().controller, Mode::kPassive, policy);
    for (auto tick = ticks().begin(); tick < from; ++tick) ASSERT_FALSE(first.check(*tick));
    Replay second(noisy_config().controller, Mode::kPassive, policy);
    second.restore(read_replay_state(replay_state_bytes(first.state()), "state"));
    for (auto tick = from; tick < ticks().end(); ++tick) {
      const auto difference = second.check(*tick);
      ASSERT_FALSE(difference) << difference->tick << ": " << difference->what;
    }
    EXPECT_GT(second.policy_steps(), 20u);
  }
}

/// A walk on dry sand whose second half replays from the state after the first; `state_bytes` of
/// that state.
RunResult replay_from_the_middle(const PolicyRunner& policy, std::size_t& state_bytes) {
  const ProcessConfig config = config_of("dry-sand", {}, policy.spec());
  std::vector<TickRecord> ticks;
  RunResult result = simulate({.config = config,
                               .policy = policy,
                               .plan = {.walk_s = 4.0, .start_walking = true},
                               .at_tick = [&](const auto& tick) { ticks.push_back(tick); }});
  Replay first(config.controller, Mode::kWalk, policy);
  const auto middle = ticks.begin() + std::ssize(ticks) / 2;
  const auto expect_same = [](Replay& replay, auto tick, auto end) {
    for (; tick < end; ++tick) {
      const auto difference = replay.check(*tick);
      ASSERT_FALSE(difference) << difference->tick << ": " << difference->what;
    }
  };
  expect_same(first, ticks.begin(), middle);
  const std::string bytes = replay_state_bytes(first.state());
  Replay second(config.controller, Mode::kWalk, policy);
  second.restore(read_replay_state(bytes, "state"));
  expect_same(second, middle, ticks.end());
  state_bytes = bytes.size();
  return result;
}

constexpr std::size_t kBytesOfAnLstm =
    16 + sizeof(ReplayState) - sizeof(TcnPast) - sizeof(PerceptronPast);

TEST(OtherNetworkTest, TcnWalksAndReplaysFromWhatItsLayersHaveRead) {
  std::size_t bytes = 0;
  const RunResult result = replay_from_the_middle(PolicyRunner(load_policy(SANDRUNNER_TCN)), bytes);
  EXPECT_EQ(result.fall_reason, "");
  EXPECT_NEAR(result.figures.motion.value().mean_velocity_mps[0], 1.0, 0.2);
  EXPECT_EQ(bytes, kBytesOfAnLstm + sizeof(TcnPast));
}

TEST(OtherNetworkTest, PerceptronReplaysFromTheObservationsThatItHasSeen) {
  std::size_t bytes = 0;
  replay_from_the_middle(PolicyRunner(policy_of_others()), bytes);
  EXPECT_EQ(bytes, kBytesOfAnLstm + sizeof(PerceptronPast));
}

TEST(OtherNetworkTest, LstmKeepsTheStateOfOldRecordings) {
  const PolicyRunner policy(load_shipped_policy());
  const Replay lstm(config_of("dry-sand", {}, policy.spec()).controller, Mode::kWalk, policy);
  EXPECT_EQ(replay_state_bytes(lstm.state()).size(), kBytesOfAnLstm);
}

TEST_F(ReplayTest, GateCounterIsComparedAndNamed) {
  std::vector<TickRecord> spoilt(ticks().begin(), ticks().begin() + 1000);
  spoilt[100].counters.torque_clamped += 7;
  const auto difference = replay(spoilt, noisy_config(), Mode::kPassive);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->tick, 100u);
  EXPECT_EQ(difference->what, "ticks_torque_clamped: recorded 7, computed 0");
}

TEST_F(ReplayTest, MissingTicksAreCountedAndSkippedSlotsAreNot) {
  TickRecord record;
  record.input.sensors.tick = 500;
  EXPECT_EQ(missing_before(record, 500), 0u);
  EXPECT_EQ(missing_before(record, 460), 40u);
  record.skipped = 40;
  EXPECT_EQ(missing_before(record, 460), 0u);
  EXPECT_EQ(missing_before(record, 459), 1u);
}

TEST_F(ReplayTest, RepeatedTickIsADifference) {
  std::vector<TickRecord> twice(ticks().begin(), ticks().begin() + 1000);
  twice[500] = twice[499];
  const auto difference = replay(twice, noisy_config(), Mode::kPassive);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->what, "tick: recorded 499, expected 500");
}

}  // namespace
}  // namespace sandrunner
