// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/standard_error.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <termios.h>

#include <csignal>

namespace sandrunner {
namespace {

TEST(StandardErrorDeathTest, AStoppedTerminalHoldsNobodyUp) {
  const auto child = [] {
    signal(SIGALRM, SIG_DFL);
    alarm(10);  // ends what hangs
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) _exit(1);
    const int terminal = open(ptsname(master), O_RDWR | O_NOCTTY);
    if (terminal < 0 || !takes_output(terminal, 0)) _exit(2);
    if (tcflow(terminal, TCOOFF) != 0) _exit(3);  // Ctrl-S
    if (takes_output(terminal, 0)) _exit(4);
    dup2(terminal, STDERR_FILENO);
    to_standard_error("lost\n");
    if (tcflow(terminal, TCOON) != 0) _exit(5);
    to_standard_error("read\n");
    char text[16] = {};
    if (read(master, text, sizeof text) < 4) _exit(6);
    _exit(std::string_view(text).starts_with("read") ? 0 : 7);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace sandrunner
