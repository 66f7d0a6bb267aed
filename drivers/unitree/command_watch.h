// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace sandrunner::unitree {

/// What is sent to the robot next.
enum class WireAction : std::uint8_t {
  kNothing,
  kFollow,  ///< the controller's newest command
  kDamp,
  kOff
};

/// What is known of the controller when the next message is due.
struct ControllerSigns {
  std::uint64_t sequence = 0;   ///< of its newest command; 0: there is none yet
  std::int64_t written_ns = 0;  ///< when it wrote that, CLOCK_MONOTONIC
  bool enabled = false;         ///< that command lets the drives give torque
  bool cut = false;             ///< it has cut the drives, or it is gone
  bool ended = false;           ///< it has ended as it should
  bool foreign = false;         ///< another program commands the robot
};

/// Decides what the wire sends, whatever becomes of the controller. A controller that is silent for
/// kCommandTimeout_ns, that cut the drives or that is gone leaves its robot damped for kDamped_ns,
/// then off; a robot that was off stays off. Then nothing is sent any more, even if the controller
/// comes back. Where another program commands the robot, two programs that write alternately
/// would shake it: the wire damps for a moment and writes no more.
class CommandWatch {
 public:
  /// The message after the last one that follows a command comes 2 ms later, and the computer may
  /// hold it up for 2 ms more: no command holds for longer than 50 ms.
  static constexpr std::int64_t kCommandTimeout_ns = 46'000'000;
  static constexpr std::int64_t kDamped_ns = 2'000'000'000;
  static constexpr std::int64_t kForeignDamped_ns = 10'000'000;
  static constexpr std::int64_t kOff_ns = 20'000'000;  ///< some messages, as one may be lost

  /// To be called for each message that is due, 500 times a second.
  WireAction next(std::int64_t now_ns, const ControllerSigns& signs) noexcept {
    judge(now_ns, signs);
    const std::int64_t since_ns = now_ns - since_ns_;
    switch (stage_) {
      case Stage::kWait:
      case Stage::kSilent:
        return WireAction::kNothing;
      case Stage::kFollow:
        powered_ = signs.enabled;
        return WireAction::kFollow;
      case Stage::kForeign:
        if (since_ns < kForeignDamped_ns) return WireAction::kDamp;
        stage_ = Stage::kSilent;
        return WireAction::kNothing;
      case Stage::kDamp:
        if (powered_ && since_ns < kDamped_ns) return WireAction::kDamp;
        enter(Stage::kOff, now_ns);
        return WireAction::kOff;
      case Stage::kOff:
        if (since_ns < kOff_ns) return WireAction::kOff;
        stage_ = Stage::kSilent;
        return WireAction::kNothing;
    }
    return WireAction::kNothing;
  }

  /// The controller's commands are not followed any more, and never will be.
  bool gave_up() const noexcept { return stage_ > Stage::kFollow; }
  /// Nothing will be sent any more.
  bool is_silent() const noexcept { return stage_ == Stage::kSilent; }

 private:
  enum class Stage : std::uint8_t { kWait, kFollow, kDamp, kForeign, kOff, kSilent };

  void enter(Stage stage, std::int64_t now_ns) noexcept {
    stage_ = stage;
    since_ns_ = now_ns;
  }

  void judge(std::int64_t now_ns, const ControllerSigns& signs) noexcept {
    if (stage_ == Stage::kSilent || stage_ == Stage::kForeign) return;
    if (signs.foreign) {
      enter(stage_ == Stage::kWait ? Stage::kSilent : Stage::kForeign, now_ns);
    } else if (stage_ == Stage::kWait) {
      if (signs.cut || signs.ended) {
        stage_ = Stage::kSilent;
      } else if (signs.sequence != 0) {
        enter(Stage::kFollow, now_ns);
      }
    }
    if (stage_ != Stage::kFollow) return;
    if (signs.ended) {
      enter(Stage::kOff, now_ns);
    } else if (signs.cut || now_ns - signs.written_ns >= kCommandTimeout_ns) {
      enter(Stage::kDamp, now_ns);
    }
  }

  Stage stage_ = Stage::kWait;
  std::int64_t since_ns_ = 0;
  bool powered_ = false;
};

}  // namespace sandrunner::unitree
