// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/commands.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "rt/base/errors.h"
#include "rt/base/standard_error.h"
#include "rt/core/mode_machine.h"
#include "rt/operator/operator_desk.h"
#include "tools/ctl/dds_io.h"
#include "tools/ctl/errors.h"
#include "tools/ctl/view_reader.h"

namespace sandrunner::ctl {
namespace {

constexpr int kTries = 4;
constexpr std::int64_t kHold_ns = 400 * kMs_ns;  // a little more than dds.stale_s

// False: nobody reads the output any more.
bool print(const std::string& text) {
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() &&
         std::fflush(stdout) == 0;
}

// Overwrites the screen from its top; each line clears the rest of its row, the end what is below.
std::string on_screen(const std::string& lines) {
  std::string out = "\x1b[H";
  for (char c : lines) {
    if (c == '\n') out += "\x1b[K";
    out += c;
  }
  return out + "\x1b[J";
}

}  // namespace

void show_status(const Options& options, Interrupt& interrupt) {
  constexpr std::int64_t kRefresh_ns = 200 * kMs_ns;
  // Diagnostics come once a second, and a rate needs two messages.
  constexpr std::int64_t kCollect_ns = 2200 * kMs_ns;
  const DdsParticipant participant(options.dds, kIdentity);
  ViewReader reader(participant);
  RobotView view;
  const std::int64_t start_ns = steady_ns();
  if (options.once || isatty(STDOUT_FILENO) == 0) {
    while (steady_ns() - start_ns < kCollect_ns && !interrupt.wait(kLook_ns)) {
      reader.take_into(view);
      if (steady_ns() - start_ns > kSecond_ns && !view.alive(steady_ns())) break;
    }
    if (!view.alive(steady_ns())) {
      throw RefusedError(fmt::format("no robot: no message came {} for 1 s", place(options.dds)));
    }
    print(view.screen(steady_ns()));
    return;
  }
  const std::string title = fmt::format("sandrunner {}; Ctrl-C quits\n", place(options.dds));
  if (!print("\x1b[2J")) return;
  for (std::int64_t next_ns = start_ns + kRefresh_ns; !interrupt.wait(kLook_ns);) {
    reader.take_into(view);
    const std::int64_t now_ns = steady_ns();
    if (now_ns < next_ns) continue;
    next_ns = std::max(next_ns + kRefresh_ns, now_ns);
    if (!print(on_screen(title + view.screen(now_ns)))) return;
  }
}

void send_command(const Options& options, Interrupt& interrupt) {
  const DdsParticipant participant(options.dds, kIdentity);
  ViewReader reader(participant);
  RobotView view;
  CommandWriter writer(participant, options.dds);
  if (!interrupt.wait_until(kFindRobot_ns, [&] { return writer.has_robot(); })) {
    if (interrupt.came()) return;
    throw RefusedError(fmt::format("no robot listens on rt/cmd_vel {}", place(options.dds)));
  }
  const std::int64_t start_ns = steady_ns();
  const long long wanted =
      options.for_s ? std::max(1LL, std::llround(*options.for_s * (1e9 / kCommandPeriod_ns)))
                    : INT64_MAX;
  long long sent = 0;
  std::string mode = "-";  // Walk, if the robot ever was in it; else the latest
  // Each has its own time since the start: a late one does not delay the next.
  while (sent < wanted && !interrupt.came()) {
    if (!writer.has_robot()) {
      throw RefusedError(fmt::format("the robot is gone after {} commands", sent));
    }
    writer.send(options.velocity);
    ++sent;
    reader.take_into(view);
    if (mode != mode_name(Mode::kWalk)) mode = view.mode(steady_ns());
    if (interrupt.wait(start_ns + sent * kCommandPeriod_ns - steady_ns())) break;
  }
  // Not interrupt.wait(): after a signal it would not wait.
  for (int i = 0; i < kZeros; ++i) {
    if (i > 0) usleep(kCommandPeriod_ns / 1000);
    writer.send({});
  }
  const auto& [vx, vy, wz] = options.velocity;
  const bool zero = vx == 0.0 && vy == 0.0 && wz == 0.0;
  if (!zero && mode != "-" && mode != mode_name(Mode::kWalk)) {
    throw RefusedError(
        fmt::format("sent {} commands, none had an effect: the robot is in mode {} and obeys "
                    "velocities in walk only ({}mode arm, mode stand, mode walk)",
                    sent, mode, mode == mode_name(Mode::kFault) ? "mode reset_fault, " : ""));
  }
  print(fmt::format("sent {} commands in {:.2f} s, then zero\n", sent,
                    static_cast<double>(sent * kCommandPeriod_ns) * 1e-9));
}

void request_mode(const Options& options, Interrupt& interrupt) {
  const DdsParticipant participant(options.dds, kIdentity);
  ModeClient client(participant);
  if (!interrupt.wait_until(kFindRobot_ns, [&] { return client.has_robot(); })) {
    if (interrupt.came()) return;
    throw RefusedError(fmt::format("{}: no robot answered {}", options.mode, place(options.dds)));
  }
  // The robot may find us a moment after we find it; a request before that would be lost.
  interrupt.wait(kSettle_ns);
  std::optional<sandrunner_ModeReply> reply;
  const auto is_held = [&] { return reply && std::string_view(reply->reason) == kOtherOperator; };
  for (int tries = 0; tries == 0 || (is_held() && tries < kTries); ++tries) {
    // The velocity of a `cmd` that has just ended still holds.
    if (tries > 0) interrupt.wait(kHold_ns);
    client.ask(options.mode);
    interrupt.wait_until(kAnswer_ns, [&] { return (reply = client.reply()).has_value(); });
  }
  if (!reply) {
    throw RefusedError(fmt::format(
        "{}: no answer; it is not known whether the robot received the request", options.mode));
  }
  const std::string mode = one_line(reply->mode), robot = one_line(reply->robot);
  if (!reply->accepted) {
    throw RefusedError(fmt::format("{}: refused by {} in mode {}: {}", options.mode, robot, mode,
                                   one_line(reply->reason)));
  }
  print(fmt::format("{}: accepted by {}, mode {}\n", options.mode, robot, mode));
  const std::uint32_t robots = client.robots();
  if (robots > 1) {
    to_standard_error(
        fmt::format("sandrunner-ctl: {} robots obey {}\n", robots, place(options.dds)));
  }
}

}  // namespace sandrunner::ctl
