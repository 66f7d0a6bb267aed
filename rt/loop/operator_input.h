// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rt/core/messages.h"
#include "rt/core/safety_gate.h"

namespace sandrunner {

/// How long a robot is damped before its loop ends, whatever ends it: it is let down, not dropped.
inline constexpr std::uint64_t kDampingEnd_ticks = kControlHz;

/// What an operator sees of the tick that was just done.
struct TickFacts {
  std::uint64_t ticks = 1;  ///< how far time went on: 1, and the slots skipped before it
  Mode mode = Mode::kPassive;
  std::uint64_t faults = 0;          ///< latched bits of Fault
  Fault first_fault = Fault::kNone;  ///< that began the latch
  std::uint64_t warnings = 0;        ///< bits of Warning for which the robot lies down
  bool base_contact = false;         ///< simulated robot: its base touches the ground
  bool thigh_contact = false;        ///< likewise
  int interrupts = 0;                ///< how often a signal has asked for the end
};

/// Whether another tick follows.
enum class AfterTick : std::uint8_t { kGoOn, kEnd };

struct OperatorVerdict {
  AfterTick next = AfterTick::kGoOn;
  bool counts = false;  ///< the tick belongs to the walk that the figures are taken over

  bool goes_on() const noexcept { return next == AfterTick::kGoOn; }
};

/// Who asks the controller for things, tick by tick. Called from the control thread: wait-free.
class OperatorInput {
 public:
  virtual ~OperatorInput() = default;
  /// Command for the tick to come.
  virtual OperatorCommand command(std::uint64_t tick) noexcept = 0;
  /// Looks at the tick just done.
  virtual OperatorVerdict advance(const TickFacts& facts) noexcept = 0;
};

}  // namespace sandrunner
