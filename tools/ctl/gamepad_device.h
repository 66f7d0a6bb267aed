// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>

#include "tools/ctl/gamepad.h"

namespace sandrunner::ctl {

/// A gamepad through evdev (/dev/input/event*).
class GamepadDevice {
 public:
  /// The first gamepad that may be read; nothing: there is none.
  static std::optional<GamepadDevice> find();

  GamepadDevice(GamepadDevice&& other) noexcept;
  GamepadDevice& operator=(GamepadDevice&&) = delete;
  ~GamepadDevice();

  const std::string& name() const noexcept { return name_; }
  /// Readable when there are events, or the gamepad is gone.
  int fd() const noexcept { return fd_; }
  std::array<AxisRange, 3> ranges() const noexcept { return ranges_; }
  /// Passes all events on. False: the gamepad is gone.
  bool read_into(Gamepad& gamepad);

 private:
  explicit GamepadDevice(int fd) : fd_(fd) {}
  bool describe();  // false: it is not a gamepad

  int fd_;
  std::string name_;
  std::array<AxisRange, 3> ranges_;
};

}  // namespace sandrunner::ctl
