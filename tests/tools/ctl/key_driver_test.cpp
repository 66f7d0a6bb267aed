// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/key_driver.h"

#include <gtest/gtest.h>

#include "tools/ctl/command_pacer.h"

namespace sandrunner::ctl {
namespace {

constexpr std::int64_t kMs = 1'000'000;

void expect_command(const std::optional<VelocityCommand>& command, double vx_mps, double vy_mps,
                    double wz_radps) {
  ASSERT_TRUE(command);
  EXPECT_DOUBLE_EQ(command->vx_mps, vx_mps);
  EXPECT_DOUBLE_EQ(command->vy_mps, vy_mps);
  EXPECT_DOUBLE_EQ(command->wz_radps, wz_radps);
}

TEST(KeyDriverTest, NothingIsCommandedBeforeTheFirstKey) {
  EXPECT_FALSE(KeyDriver().command(0));
  EXPECT_FALSE(KeyDriver().command(100 * kMs));
}

TEST(KeyDriverTest, EachKeySteersItsOwnAxisAndTheLastOneCounts) {
  KeyDriver driver;
  const struct {
    char key;
    double vx_mps, vy_mps, wz_radps;
  } kCases[] = {{'w', 0.5, 0, 0},   {'s', -0.5, 0, 0}, {'a', 0, 0.25, 0},
                {'d', 0, -0.25, 0}, {'q', 0, 0, 0.5},  {'e', 0, 0, -0.5}};
  for (const auto& c : kCases) {
    EXPECT_EQ(driver.press(c.key, 0).request, nullptr);
    expect_command(driver.command(1), c.vx_mps, c.vy_mps, c.wz_radps);
  }
}

TEST(KeyDriverTest, AKeyHoldsFor600Milliseconds) {
  KeyDriver driver;
  driver.press('w', 1000 * kMs);
  EXPECT_TRUE(driver.command(1600 * kMs - 1));
  EXPECT_FALSE(driver.command(1600 * kMs));
  driver.press('w', 2000 * kMs);
  driver.press('w', 2500 * kMs);
  EXPECT_TRUE(driver.command(3100 * kMs - 1));
  EXPECT_FALSE(driver.command(3100 * kMs));
}

TEST(KeyDriverTest, KeysThatDoNotSteerEndTheMotion) {
  const std::pair<char, const char*> kCases[] = {{' ', "stop"},    {'r', "arm"},  {'g', "stand"},
                                                 {'f', "walk"},    {'x', "damp"}, {'\x1b', nullptr},
                                                 {'\x03', nullptr}};
  for (const auto& [key, name] : kCases) {
    KeyDriver driver;
    driver.press('w', 0);
    const KeyAction action = driver.press(key, 10 * kMs);
    EXPECT_EQ(action.quits, name == nullptr) << key;
    EXPECT_STREQ(action.request ? action.request->name : nullptr, name) << key;
    EXPECT_FALSE(driver.command(11 * kMs)) << key;
  }
}

TEST(KeyDriverTest, UnknownKeysNeitherSteerNorProlong) {
  KeyDriver driver;
  EXPECT_EQ(driver.press('k', 0).request, nullptr);
  EXPECT_FALSE(driver.command(1));
  driver.press('w', 0);
  driver.press('k', 500 * kMs);
  EXPECT_TRUE(driver.command(599 * kMs));
  EXPECT_FALSE(driver.command(600 * kMs));
}

TEST(KeyDriverTest, PlusAndMinusScaleBetweenATenthAndTwice) {
  KeyDriver driver;
  driver.press('w', 0);
  driver.press('+', 500 * kMs);
  expect_command(driver.command(1000 * kMs), 0.6, 0, 0);  // prolonged
  for (int i = 0; i < 30; ++i) driver.press('+', 600 * kMs);
  expect_command(driver.command(600 * kMs), 2.0, 0, 0);
  for (int i = 0; i < 30; ++i) driver.press('-', 600 * kMs);
  expect_command(driver.command(600 * kMs), 0.1, 0, 0);
  driver.press('=', 600 * kMs);
  EXPECT_EQ(driver.scale_tenths(), 2);
}

TEST(KeyDriverTest, AChangeOfScaleDoesNotReviveAnExpiredKey) {
  KeyDriver driver;
  driver.press('w', 0);
  driver.press('+', 700 * kMs);
  EXPECT_FALSE(driver.command(701 * kMs));
}

TEST(KeysFromTest, LeavesSpecialKeysOutAndLowersLetters) {
  EXPECT_EQ(KeyReader().keys("wW "), (std::vector<char>{'w', 'w', ' '}));
  EXPECT_EQ(KeyReader().keys("\x1b[Aw\x1b[1;5Cs\x1bOPd"), (std::vector<char>{'w', 's', 'd'}));
  EXPECT_EQ(KeyReader().keys("\x1b"), (std::vector<char>{kKeyEscape}));
  EXPECT_EQ(KeyReader().keys("\x1b["), std::vector<char>{});
  EXPECT_EQ(KeyReader().keys("\x1b\x1b[A"), (std::vector<char>{kKeyEscape}));
}

// Asks every `step_ns` from `from_ns` until before `to_ns`; returns the times at which it sent.
std::vector<std::int64_t> sent(CommandPacer& pacer, const std::optional<VelocityCommand>& wanted,
                               std::int64_t from_ns, std::int64_t to_ns, std::int64_t step_ns) {
  std::vector<std::int64_t> times;
  for (std::int64_t t = from_ns; t < to_ns; t += step_ns) {
    const auto command = pacer.due(wanted, t);
    if (!command) continue;
    EXPECT_EQ(command->vx_mps, wanted ? wanted->vx_mps : 0.0);
    times.push_back(t);
  }
  return times;
}

TEST(CommandPacerTest, SendsNothingBeforeSomebodySteers) {
  CommandPacer pacer;
  EXPECT_TRUE(sent(pacer, std::nullopt, 0, 1000 * kMs, kMs).empty());
  EXPECT_FALSE(pacer.busy());
}

TEST(CommandPacerTest, SendsTwentyASecondFromTheFirstMomentOn) {
  CommandPacer pacer;
  const auto times = sent(pacer, VelocityCommand{.vx_mps = 0.5}, 7000 * kMs, 8000 * kMs, 7 * kMs);
  ASSERT_EQ(times.size(), 20u);  // on the grid, although it is asked every 7 ms
  EXPECT_EQ(times.front(), 7000 * kMs);
  EXPECT_GE(times.back(), 7950 * kMs);
}

TEST(CommandPacerTest, SendsZeroFiveTimesAtTheEndThenNothing) {
  CommandPacer pacer;
  sent(pacer, VelocityCommand{.vx_mps = 0.5}, 0, 103 * kMs, kMs);  // the last one at 100 ms
  EXPECT_TRUE(pacer.busy());
  const auto zeros = sent(pacer, std::nullopt, 103 * kMs, 2000 * kMs, kMs);
  EXPECT_EQ(zeros,
            (std::vector<std::int64_t>{103 * kMs, 153 * kMs, 203 * kMs, 253 * kMs, 303 * kMs}));
  EXPECT_FALSE(pacer.busy());
}

TEST(CommandPacerTest, SendsOneCommandAndNoBurstAfterAStall) {
  CommandPacer pacer;
  const VelocityCommand wanted{.vx_mps = 0.5};
  sent(pacer, wanted, 0, 60 * kMs, kMs);
  const auto times = sent(pacer, wanted, 1000 * kMs, 1100 * kMs, kMs);
  EXPECT_EQ(times, (std::vector<std::int64_t>{1000 * kMs, 1050 * kMs}));
}

TEST(CommandPacerTest, SteeringAgainDuringTheZerosGoesOn) {
  CommandPacer pacer;
  const VelocityCommand wanted{.vx_mps = 0.5};
  sent(pacer, wanted, 0, 60 * kMs, kMs);
  sent(pacer, std::nullopt, 60 * kMs, 150 * kMs, kMs);
  EXPECT_EQ(sent(pacer, wanted, 150 * kMs, 250 * kMs, kMs).size(), 2u);
  EXPECT_EQ(sent(pacer, std::nullopt, 250 * kMs, 2000 * kMs, kMs).size(), 5u);
}

TEST(KeyReaderTest, PastedTextPressesNoKey) {
  KeyReader reader;
  EXPECT_EQ(reader.keys("w\x1b[200~rgf \x03\x1b[Arg\x1b[201~x"), (std::vector<char>{'w', 'x'}));
  EXPECT_EQ(reader.keys("a"), (std::vector<char>{'a'}));
  // However the reads cut it, but for the first ESC, which is a key.
  const std::string pasted = "\x1b[200~rgf\x1brgf\x1b[201~";
  for (std::size_t cut = 2; cut < pasted.size(); ++cut) {
    EXPECT_EQ(reader.keys(pasted.substr(0, cut)), std::vector<char>{}) << cut;
    EXPECT_EQ(reader.keys(pasted.substr(cut)), std::vector<char>{}) << cut;
  }
  EXPECT_EQ(reader.keys("a"), (std::vector<char>{'a'}));
}

}  // namespace
}  // namespace sandrunner::ctl
