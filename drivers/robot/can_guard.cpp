// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/can_guard.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <variant>

#include "drivers/can/can_socket.h"
#include "drivers/robot/drive.h"
#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"
#include "rt/base/guard_process.h"

namespace sandrunner {
namespace {

constexpr std::int64_t kLook_ns = 2'000'000;
// A look later than this was held up itself: so, most likely, was the controller.
constexpr std::int64_t kHeldUp_ns = 5 * kLook_ns;
// Off frames are repeated: one may be lost, and a stopped controller may send its last set-point.
constexpr std::int64_t kRepeat_ns = 1'000'000'000;
constexpr std::int64_t kOpen_ns = 2'000'000'000;
// Above the control thread, 80: it must not wait for one that hangs.
constexpr int kPriority = 81;

}  // namespace

/// What both processes share.
struct CanGuard::Memory {
  std::atomic<std::int64_t> commanded_ns{0};  ///< the newest command that enables; 0: all are off
  std::atomic<bool> start{false}, ready{false}, failed{false}, cut{false}, ended{false};
  std::array<char, 500> error{};
  static_assert(std::atomic<std::int64_t>::is_always_lock_free);
};

CanGuard::CanGuard(const OffFrames& off, double timeout_s, const Open& open)
    : memory_(std::make_unique<Shared<Memory>>("hardware")) {
  const pid_t controller = getpid();
  pid_ = fork_process("hardware");
  if (pid_ == 0) live(off, static_cast<std::int64_t>(1e9 * timeout_s), open, **memory_, controller);
}

CanGuard::~CanGuard() {
  Memory& memory = **memory_;
  memory.ended = true;
  if (memory.cut) return;
  kill(pid_, SIGKILL);  // it has nothing to do any more
  waitpid(pid_, nullptr, 0);
}

void CanGuard::start() {
  Memory& memory = **memory_;
  memory.start = true;
  for (std::int64_t waited_ns = 0; waited_ns < kOpen_ns && !memory.failed; waited_ns += kLook_ns) {
    if (memory.ready) return;
    pause_ns(kLook_ns);
  }
  if (memory.failed) throw InputError(memory.error.data());
  throw InputError("hardware: the process that guards the drives does not answer");
}

void CanGuard::note_command(std::int64_t now_ns) noexcept {
  (*memory_)->commanded_ns.store(now_ns, std::memory_order_relaxed);
}

void CanGuard::note_off() noexcept { (*memory_)->commanded_ns.store(0, std::memory_order_relaxed); }

bool CanGuard::has_cut() const noexcept { return (*memory_)->cut.load(std::memory_order_relaxed); }

void CanGuard::live(const OffFrames& off, std::int64_t timeout_ns, const Open& open, Memory& memory,
                    pid_t controller) {
  become_guard("legs-guard");
  const int process = open_process(controller);
  const auto controller_runs = [&] { return process_runs(process) && getppid() == controller; };
  while (!memory.start) {
    if (!controller_runs()) _exit(0);
    pause_ns(kLook_ns);
  }
  Send send;
  try {
    send = open();
  } catch (const std::exception& error) {
    write_text(error.what(), memory.error);
    memory.failed = true;
    _exit(0);
  }
  become_real_time(kPriority);  // without it: as well as it can
  memory.ready = true;
  std::int64_t looked_ns = clock_ns(CLOCK_MONOTONIC), held_up_ns = 0;
  for (;;) {
    pause_ns(kLook_ns);
    const bool runs = controller_runs();
    const std::int64_t commanded_ns = memory.commanded_ns;
    const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
    if (now_ns - looked_ns > kHeldUp_ns) held_up_ns = now_ns;
    looked_ns = now_ns;
    const bool silent = now_ns - std::max(commanded_ns, held_up_ns) > timeout_ns;
    if (commanded_ns != 0 && (silent || !runs)) break;
    if (!runs || memory.ended) _exit(0);
  }
  memory.cut = true;
  const std::int64_t end_ns = clock_ns(CLOCK_MONOTONIC) + kRepeat_ns;
  while (clock_ns(CLOCK_MONOTONIC) < end_ns) {
    for (std::size_t bus = 0; bus < off.size(); ++bus) {
      if (!off[bus].empty()) send(bus, off[bus]);
    }
    pause_ns(2 * kLook_ns);
  }
  _exit(0);
}

OffFrames off_frames(const HardwareConfig& config, bool unverified) {
  OffFrames frames(config.buses.size());
  for (const DriveConfig& drive : config.drives) {
    const bool hidden = std::visit([](const auto& d) { return hides_timeout(d); }, drive.drive);
    if (unverified && !hidden) continue;
    CanFrame frame;
    Drive(drive, config).off_frame(frame);
    frames[static_cast<std::size_t>(drive.bus)].push_back(frame);
  }
  return frames;
}

CanGuard::Open open_buses_of(const HardwareConfig& config) {
  return [buses = config.buses]() -> CanGuard::Send {
    auto sockets = std::make_shared<std::vector<std::unique_ptr<CanSocket>>>();
    for (const BusConfig& bus : buses) {
      sockets->push_back(std::make_unique<CanSocket>(CanSocketConfig{
          .interface = bus.interface, .fd = bus.format != CanFormat::kClassic, .filters = {}}));
    }
    return [sockets](std::size_t bus, std::span<const CanFrame> frames) {
      (*sockets)[bus]->send(frames);
    };
  };
}

}  // namespace sandrunner
