// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <optional>

#include "rt/base/errors.h"
#include "tools/ctl/command_pacer.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/dds_io.h"
#include "tools/ctl/errors.h"
#include "tools/ctl/key_driver.h"
#include "tools/ctl/raw_terminal.h"
#include "tools/ctl/view_reader.h"

namespace sandrunner::ctl {
namespace {

std::string help() {
  std::string requests;
  for (const RequestRow& row : kRequestTable) {
    if (row.key == '\0') continue;
    requests +=
        fmt::format("{} {}   ", row.key == ' ' ? "space" : std::string(1, row.key), row.name);
  }
  return "w/s forward, backward   a/d left, right   q/e turn   +/- faster, slower\n" + requests +
         "ESC or Ctrl-C quit\n";
}

// Errors are ignored: output that nobody can read is no reason to end the drive.
void say(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

// Characters that fit on a line; a longer one would scroll.
std::size_t columns() {
  winsize size{};
  const bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col - 1u : 79u;
}

class Drive {
 public:
  Drive(const Options& options, Interrupt& interrupt)
      : interrupt_(interrupt),
        participant_(options.dds, kIdentity),
        writer_(participant_, options.dds),
        modes_(participant_),
        reader_(participant_),
        where_(place(options.dds)) {}

  void run() {
    if (!interrupt_.wait_until(kFindRobot_ns,
                               [&] { return writer_.has_robot() && modes_.has_robot(); })) {
      if (interrupt_.came()) return;
      throw RefusedError(fmt::format("drive: no robot answered {}", where_));
    }
    RawTerminal terminal;
    say(help());
    while (!quit_ && !interrupt_.came()) {
      poll_inputs(terminal);
      step();
    }
    keys_.press(' ', steady_ns());
    while (pacer_.busy()) {
      send(std::nullopt);
      usleep(5000);
    }
    say("\n");
  }

 private:
  void poll_inputs(RawTerminal& terminal) {
    pollfd fds[2] = {{interrupt_.fd(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    if (poll(fds, 2, kLook_ns / kMs_ns) <= 0 || fds[1].revents == 0) return;
    const std::string bytes = terminal.read();
    if (bytes.empty()) quit_ = true;
    for (const char key : key_reader_.keys(bytes)) press(key);
  }

  void press(char key) {
    const KeyAction action = keys_.press(key, steady_ns());
    quit_ = quit_ || action.quits;
    if (!action.request) return;
    send(std::nullopt);  // zero at once, before the request
    modes_.ask(action.request->name);
    asked_ = action.request->name;
    waits_ = true;
    asked_ns_ = steady_ns();
  }

  void step() {
    const std::int64_t now_ns = steady_ns();
    if (const auto reply = modes_.reply()) {
      report(asked_ + (reply->accepted ? ": accepted" : ": refused: " + one_line(reply->reason)));
      waits_ = false;
    } else if (waits_ && now_ns - asked_ns_ > kAnswer_ns) {
      report(asked_ + ": no answer");  // it may come yet
      waits_ = false;
    }
    send(keys_.command(now_ns));
    reader_.take_into(view_);
    if (now_ns < next_line_ns_) return;
    next_line_ns_ = now_ns + 200 * kMs_ns;
    const std::string line =
        fmt::format("scale {:.1f}  {}", 0.1 * keys_.scale_tenths(), view_.line(now_ns));
    say("\r\x1b[K" + line.substr(0, columns()));
  }

  // A line that stays, above the one that is refreshed.
  static void report(const std::string& text) { say("\r\x1b[K" + text + "\n"); }

  void send(const std::optional<VelocityCommand>& wanted) {
    if (const auto command = pacer_.due(wanted, steady_ns())) writer_.send(*command);
  }

  Interrupt& interrupt_;
  DdsParticipant participant_;
  CommandWriter writer_;
  ModeClient modes_;
  ViewReader reader_;
  RobotView view_;
  KeyReader key_reader_;
  KeyDriver keys_;
  CommandPacer pacer_;
  const std::string where_;  // the robot is looked for
  bool quit_ = false;
  std::string asked_;   // the latest request
  bool waits_ = false;  // for its answer
  std::int64_t asked_ns_ = 0, next_line_ns_ = 0;
};

}  // namespace

void drive_robot(const Options& options, Interrupt& interrupt) {
  if (isatty(STDIN_FILENO) == 0) {
    throw InputError("drive: found a standard input that is not a terminal, expected a keyboard");
  }
  Drive(options, interrupt).run();
}

}  // namespace sandrunner::ctl
