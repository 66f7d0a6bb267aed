// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rt/core/messages.h"

namespace sandrunner {

/// A velocity command above this is absurd: it is refused, not clamped.
inline constexpr double kAbsurdSpeed_mps = 5.0;
inline constexpr double kAbsurdYawRate_radps = 10.0;

/// A Twist as received.
struct Twist {
  Vector3 linear_mps{};
  Vector3 angular_radps{};
};

/// kObjection is not the gate's: who passes the command on objects (OperatorDesk).
enum class CommandVerdict { kAccepted, kNotFinite, kAbsurd, kOtherPublisher, kObjection };

/// Decides which velocity commands are accepted: finite ones of sensible size, from one publisher
/// at a time. The first publisher holds the command until it has sent no good one for the stale
/// time.
class CommandGate {
 public:
  explicit CommandGate(std::int64_t stale_ns) : stale_ns_(stale_ns) {}

  /// `publisher`: the sender; `now_ns`: steady clock at the arrival.
  CommandVerdict judge(const Twist& twist, std::uint64_t publisher, std::int64_t now_ns) noexcept;

  /// Whether a publisher holds the command.
  bool held(std::int64_t now_ns) const noexcept { return held_ && now_ns - last_ns_ <= stale_ns_; }

 private:
  std::int64_t stale_ns_;
  bool held_ = false;
  std::uint64_t holder_ = 0;
  std::int64_t last_ns_ = 0;  // when the holder's last good command arrived
};

}  // namespace sandrunner
