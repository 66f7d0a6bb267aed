// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/signals_as_stop.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

namespace sandrunner {
namespace {

TEST(SignalsAsStopDeathTest, AnInterruptIsNotedAndEndsTheProcessOnceTheDrivesAreOff) {
  const auto push = [] {
    const SignalsAsStop signals;
    if (signals.stopped()) _exit(1);
    std::raise(SIGINT);
    if (!signals.stopped()) _exit(2);
  };
  EXPECT_EXIT(push(), testing::KilledBySignal(SIGINT), "");
}

TEST(SignalsAsStopTest, WhatWasIgnoredBeforeIsIgnoredAfter) {
  std::signal(SIGHUP, SIG_IGN);
  {
    const SignalsAsStop signals;
    std::raise(SIGHUP);
    EXPECT_TRUE(signals.stopped());
  }
  EXPECT_EQ(std::signal(SIGHUP, SIG_DFL), SIG_IGN);
}

}  // namespace
}  // namespace sandrunner
