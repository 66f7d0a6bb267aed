// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rt/loop/operator_input.h"

namespace sandrunner {

/// Passes on what another operator commands, until `begin` starts the return to Stand. Then it
/// makes the requests that the mode machine needs from its present mode, the reset of a latched
/// fault included. A request of the other operator ends that. For a simulated robot that the viewer
/// holds upright meanwhile. Called from the control thread.
class ReturnToStand final : public OperatorInput {
 public:
  /// `other` must outlive it.
  explicit ReturnToStand(OperatorInput& other) : other_(other) {}

  void begin() noexcept;
  /// The robot is to be held: it does not carry itself yet.
  bool holds() const noexcept;
  /// It is held so that it can stand from there; before, this only requests its rest.
  void is_upright() noexcept { upright_ = true; }

  OperatorCommand command(std::uint64_t tick) noexcept override;
  OperatorVerdict advance(const TickFacts& facts) noexcept override;

 private:
  enum class Phase { kIdle, kDown, kUp };  // kDown: until it rests and is upright
  ModeRequest wanted() const noexcept;

  OperatorInput& other_;
  Phase phase_ = Phase::kIdle;
  bool upright_ = false;
  Mode mode_ = Mode::kPassive;
  OperatorCommand command_;
  std::uint64_t others_id_ = 0;  // of the other operator's latest request
  std::uint64_t ticks_ = 0;      // since begin()
};

}  // namespace sandrunner
