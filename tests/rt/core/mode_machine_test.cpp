// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/mode_machine.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace sandrunner {
namespace {

constexpr Mode P = Mode::kPassive, D = Mode::kDamping, U = Mode::kStandUp, S = Mode::kStand,
               W = Mode::kWalk, F = Mode::kFault;

TEST(ModeMachineTest, EveryEventInEveryModeLeadsWhereTheTableSays) {
  // Columns in the order of Event: passive, damp, stand, walk, reset, arm, stop, lie, stood up,
  // stopped, lowered, fault.
  const Mode expected[6][kNumEvents] = {
      /* Passive */ {P, P, P, P, P, D, P, P, P, P, P, F},
      /* Damping */ {P, D, U, D, D, D, D, D, D, D, D, F},
      /* StandUp */ {U, D, U, U, U, U, D, S, S, U, U, F},
      /* Stand   */ {S, D, S, W, S, S, S, S, S, S, D, F},
      /* Walk    */ {W, D, W, W, W, W, W, W, W, S, W, F},
      /* Fault   */ {F, F, F, F, P, F, F, F, F, F, F, F},
  };
  for (int mode = 0; mode < 6; ++mode) {
    for (int event = 0; event < kNumEvents; ++event) {
      EXPECT_EQ(next_mode(static_cast<Mode>(mode), static_cast<Event>(event)),
                expected[mode][event])
          << mode_name(static_cast<Mode>(mode)) << ", event " << event;
    }
  }
}

TEST(ModeMachineTest, EveryRequestHasOneRowAndKeysAreUnlike) {
  std::set<std::string> names;
  std::set<char> keys;
  for (const RequestRow& row : kRequestTable) {
    EXPECT_EQ(row_of(row.request), &row);
    EXPECT_EQ(request_named(row.name), &row);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    if (row.key != 0) {
      EXPECT_TRUE(keys.insert(row.key).second) << row.name;
    }
  }
  EXPECT_EQ(row_of(ModeRequest::kNone), nullptr);
  EXPECT_EQ(request_named("jump"), nullptr);
}

TEST(ModeMachineTest, TableHasNoIdleOrDoubleRow) {
  std::set<std::pair<Mode, Event>> seen;
  for (const Transition& t : kTransitions) {
    EXPECT_NE(t.from, t.to);
    EXPECT_TRUE(seen.insert({t.from, t.event}).second);
  }
}

TEST(ModeMachineTest, NamesAreStable) {
  const char* expected[] = {"passive", "damping", "stand_up", "stand", "walk", "fault"};
  for (int mode = 0; mode < 6; ++mode) {
    EXPECT_STREQ(mode_name(static_cast<Mode>(mode)), expected[mode]);
  }
}

}  // namespace
}  // namespace sandrunner
