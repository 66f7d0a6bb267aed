// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "drivers/can/can_frame.h"
#include "drivers/robot/hardware_config.h"
#include "rt/base/guard_process.h"

namespace sandrunner {

/// The off frames of the drives, for each bus.
using OffFrames = std::vector<std::vector<CanFrame>>;

/// A process that switches drives off when the controller is killed, hangs or is stopped, for
/// drives that cannot report their own time-out (`hardware.timeout_unverified`). It has sockets of
/// its own and sends nothing before. Example: can_guard_test.cpp.
class CanGuard {
 public:
  /// Sends frames on a bus.
  using Send = std::function<void(std::size_t bus, std::span<const CanFrame> frames)>;
  /// Opens the buses; in the guard's process. Throws InputError.
  using Open = std::function<Send()>;

  /// Forks it; it does nothing yet. `timeout_s`: without a command for this long, drives that are
  /// on are switched off. To be called while this process has one thread. Throws InputError.
  CanGuard(const OffFrames& off, double timeout_s, const Open& open);
  /// Ends it.
  ~CanGuard();
  CanGuard(const CanGuard&) = delete;
  CanGuard& operator=(const CanGuard&) = delete;

  /// Has it open the buses. Throws InputError.
  void start();

  // The control thread's part; real-time safe.

  /// Drives got a command that enables them.
  void note_command(std::int64_t now_ns) noexcept;
  /// All drives are commanded off.
  void note_off() noexcept;
  /// It has switched the drives off, for good.
  bool has_cut() const noexcept;

 private:
  struct Memory;
  [[noreturn]] static void live(const OffFrames& off, std::int64_t timeout_ns, const Open& open,
                                Memory& memory, pid_t controller);

  std::unique_ptr<Shared<Memory>> memory_;
  pid_t pid_ = 0;
};

/// The off frames of this robot's drives; `unverified`: only of those that cannot report their own
/// time-out. (A moteus damps by its own; one that is commanded off would be limp.)
OffFrames off_frames(const HardwareConfig& config, bool unverified);

/// Opens this robot's buses, to send alone.
CanGuard::Open open_buses_of(const HardwareConfig& config);

}  // namespace sandrunner
