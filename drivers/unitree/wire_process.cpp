// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/wire_process.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "drivers/unitree/command_watch.h"
#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"

namespace sandrunner::unitree {
namespace {

constexpr std::int64_t kPeriod_ns = 2'000'000;  // 500 Hz
constexpr std::int64_t kModeLook_ns = 1'000'000'000;
// Below the control thread, 80, and above the policy thread, 70.
constexpr int kPriority = 76, kReceivePriority = 75;
constexpr int kConnect_s = 30;
constexpr int kLook_ms = 10, kHungLooks = 10;  // of the guard at the wire

/// The wire, in its process.
class Wire {
 public:
  /// `controller`: a pidfd.
  Wire(const UnitreeConfig& config, const RobotFigures& robot, WireMemory& memory, int controller)
      : config_(config), robot_(robot), memory_(memory), controller_(controller) {}

  void run() {
    while (!memory_.start) {
      if (!may_go_on()) return;
      pause_ns(5'000'000);
    }
    memory_.phase = WirePhase::kStarting;
    memory_.real_time = become_real_time(kPriority);
    RobotLink link(config_, memory_.real_time ? kReceivePriority : 0);
    bring_up(link, config_, robot_, [this] { return may_go_on(); });
    if (!may_go_on()) return;
    foreign_before_ = link.foreign_commands();
    report(link);
    memory_.phase = WirePhase::kReady;
    send_until_silent(link);
  }

 private:
  bool controller_is_there() const { return process_runs(controller_) && getppid() == guard_; }
  bool may_go_on() const { return controller_is_there() && !memory_.ended; }

  void report(RobotLink& link) {
    const StateWatch& states = link.states();
    memory_.report.write({.state = states.state(),
                          .sampled_ns = states.sampled_ns(),
                          .counters = states.counters()});
  }

  void send_until_silent(RobotLink& link) {
    std::int64_t due_ns = clock_ns(CLOCK_MONOTONIC) + kPeriod_ns;
    std::int64_t look_ns = due_ns;
    while (!watch_.is_silent()) {
      ++memory_.turns;
      std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
      if (now_ns < due_ns) {
        if (link.wait(due_ns)) report(link);
        continue;
      }
      if (link.poll()) report(link);
      look_for_others(link, now_ns, look_ns);
      send(link, now_ns);
      now_ns = clock_ns(CLOCK_MONOTONIC);
      due_ns = std::max(due_ns + kPeriod_ns, now_ns - kPeriod_ns);  // it keeps its grid
    }
    // The guard, too, leaves a robot to another program that commands it.
    memory_.powered = false;
    // The controller still hears of the robot until it ends.
    while (may_go_on()) {
      ++memory_.turns;
      if (link.wait(clock_ns(CLOCK_MONOTONIC) + 5 * kPeriod_ns)) report(link);
    }
  }

  void look_for_others(RobotLink& link, std::int64_t now_ns, std::int64_t& look_ns) {
    const std::uint64_t foreign = link.foreign_commands() - foreign_before_;
    memory_.foreign_commands = foreign;
    if (foreign > 0) memory_.foreign = true;
    if (!config_.release_sport_mode) return;
    if (const auto answer = link.switcher().take()) {
      const auto mode = mode_name(answer->data);
      if (mode && !mode->empty()) memory_.foreign = true;
    }
    if (now_ns < look_ns) return;
    look_ns = now_ns + kModeLook_ns;
    link.switcher().send(SwitcherRequest::kCheckMode);
  }

  void send(RobotLink& link, std::int64_t now_ns) {
    const WireCommand& command = memory_.command.read();
    const bool ended = memory_.ended;
    const ControllerSigns signs{.sequence = memory_.command.sequence(),
                                .written_ns = command.written_ns,
                                .enabled = command.enabled != 0,
                                .cut = memory_.cut || (!ended && !controller_is_there()),
                                .ended = ended,
                                .foreign = memory_.foreign};
    const WireAction action = watch_.next(now_ns, signs);
    memory_.gave_up = watch_.gave_up();
    const auto mode = static_cast<std::uint8_t>(config_.motor_mode);
    switch (action) {
      case WireAction::kNothing:
        return;
      case WireAction::kFollow:
        if (command.enabled == 0) {
          encode_off(message_);
        } else if (!encode_joints(mode, command.joints, command.blind_joints, message_)) {
          encode_damping(mode, robot_.damping_kd_nmsprad, message_);
        }
        break;
      case WireAction::kDamp:
        encode_damping(mode, robot_.damping_kd_nmsprad, message_);
        break;
      case WireAction::kOff:
        encode_off(message_);
        break;
    }
    const bool powers = message_.motor_cmd[0].mode != kMotorOff;
    if (powers) memory_.powered = true;  // before it is sent: this process may be killed in between
    link.send(message_);
    memory_.powered = powers;
    memory_.sent = link.sent();
    memory_.not_sent = link.not_sent();
  }

  const UnitreeConfig& config_;
  const RobotFigures& robot_;
  WireMemory& memory_;
  const int controller_;
  const pid_t guard_ = getppid();
  CommandWatch watch_;
  LowCmd message_;
  std::uint64_t foreign_before_ = 0;
};

void note_error(WireMemory& memory, const std::string& error) {
  write_text(error, memory.error);
  memory.phase = WirePhase::kFailed;
}

/// The wire's whole life; never returns.
[[noreturn]] void live(const UnitreeConfig& config, const RobotFigures& robot, WireMemory& memory,
                       int controller) {
  rename_process("legs-wire");
  int code = 1;
  try {
    Wire(config, robot, memory, controller).run();
    if (memory.phase != WirePhase::kFailed) memory.phase = WirePhase::kEnded;
    code = 0;
  } catch (const InputError& error) {
    note_error(memory, error.what());
  } catch (const std::exception& error) {
    note_error(memory, fmt::format("hardware.unitree: {}", error.what()));
  }
  _exit(code);
}

/// Waits for the end of the wire; false: not by itself, or after an error. One that powers motors
/// and makes no turn at kHungLooks looks is killed. Looks are counted, not time: the guard may have
/// been stopped as well.
bool ends_well(pid_t wire, const WireMemory& memory) {
  pollfd ended{.fd = open_process(wire), .events = POLLIN, .revents = 0};
  std::uint64_t turns = 0;
  for (int looks = 0; ended.fd >= 0 && poll(&ended, 1, kLook_ms) <= 0; ++looks) {
    if (!memory.powered || memory.turns != turns) looks = 0;
    turns = memory.turns;
    if (looks == kHungLooks) kill(wire, SIGKILL);
  }
  int status = 0;
  while (waitpid(wire, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Damps a robot whose wire is gone, then switches it off.
void take_over(const UnitreeConfig& config, const RobotFigures& robot) {
  RobotLink link(config, become_real_time(kPriority) ? kReceivePriority : 0);
  link.open_commands();
  LowCmd message;
  const auto send_for = [&](std::int64_t time_ns) {
    const std::int64_t end_ns = clock_ns(CLOCK_MONOTONIC) + time_ns;
    while (clock_ns(CLOCK_MONOTONIC) < end_ns) {
      link.send(message);
      pause_ns(2'000'000);
    }
  };
  encode_damping(static_cast<std::uint8_t>(config.motor_mode), robot.damping_kd_nmsprad, message);
  for (int i = 0; i < kConnect_s * 100 && !link.commands_are_read(); ++i) send_for(10'000'000);
  send_for(CommandWatch::kDamped_ns);
  encode_off(message);
  send_for(CommandWatch::kOff_ns);
}

/// The guard's whole life; never returns.
[[noreturn]] void guard(const UnitreeConfig& config, const RobotFigures& robot, WireMemory& memory,
                        pid_t controller) {
  become_guard("legs-guard");  // and so the wire: only its name is another
  const int process = open_process(controller);
  if (process < 0 || getppid() != controller) _exit(0);
  const pid_t sender = fork();
  if (sender == 0) live(config, robot, memory, process);
  if (sender < 0) {
    note_error(memory, "hardware.unitree: no process can be started");
    _exit(0);
  }
  memory.sender = sender;
  if (!ends_well(sender, memory) && memory.powered) {
    memory.guarding = true;
    try {
      take_over(config, robot);
    } catch (const InputError&) {
      // The network is gone: nothing can be sent any more.
    }
  }
  _exit(0);
}

}  // namespace

WireProcess::WireProcess(const UnitreeConfig& config, const RobotFigures& robot)
    : memory_("hardware.unitree") {
  const pid_t controller = getpid();
  pid_ = fork_process("hardware.unitree");
  if (pid_ == 0) guard(config, robot, *memory_, controller);
  process_ = open_process(pid_);
}

WireProcess::~WireProcess() {
  memory_->ended = true;
  const auto wait_1s = [this] {
    for (int i = 0; i < 200 && runs() && !memory_->guarding; ++i) pause_ns(5'000'000);
  };
  wait_1s();
  if (runs() && !memory_->guarding && memory_->sender > 0) {
    kill(memory_->sender, SIGKILL);  // whose guard then damps motors that are on
    wait_1s();
  }
  if (!memory_->guarding) {
    if (runs()) kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(process_);
}

bool WireProcess::runs() const noexcept { return process_runs(process_); }

void WireProcess::connect() {
  memory_->start = true;
  for (int i = 0; i < kConnect_s * 100; ++i) {
    if (memory_->phase == WirePhase::kReady) return;
    if (memory_->phase == WirePhase::kFailed) throw InputError(memory_->error.data());
    if (!runs()) throw InputError("hardware.unitree: the process of the wire has ended");
    pause_ns(10'000'000);
  }
  throw InputError(fmt::format("hardware.unitree: the robot is not ready after {} s", kConnect_s));
}

}  // namespace sandrunner::unitree
