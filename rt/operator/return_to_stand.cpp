// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/return_to_stand.h"

#include <algorithm>

namespace sandrunner {
namespace {

// The controller ignores a reset while it still damps after the fault.
constexpr std::uint64_t kAskAgain_ticks = kControlHz / 4;
constexpr std::uint64_t kLongest_ticks = 10 * kControlHz;

}  // namespace

void ReturnToStand::begin() noexcept {
  phase_ = Phase::kDown;
  upright_ = false;
  ticks_ = 0;
}

bool ReturnToStand::holds() const noexcept {
  return phase_ == Phase::kDown ||
         (phase_ == Phase::kUp && mode_ != Mode::kStandUp && mode_ != Mode::kStand);
}

OperatorCommand ReturnToStand::command(std::uint64_t tick) noexcept {
  const OperatorCommand other = other_.command(tick);
  command_.velocity = other.velocity;
  command_.tick = std::max(command_.tick, other.tick);
  if (other.request_id != others_id_) {
    others_id_ = other.request_id;
    phase_ = Phase::kIdle;
    command_.ask(other.request);
  }
  if (phase_ == Phase::kIdle) return command_;
  command_.velocity = {};
  command_.tick = tick;
  const ModeRequest next = wanted();
  const bool again = ticks_ % kAskAgain_ticks == 0;
  if (next != ModeRequest::kNone && (next != command_.request || again)) command_.ask(next);
  return command_;
}

OperatorVerdict ReturnToStand::advance(const TickFacts& facts) noexcept {
  mode_ = facts.mode;
  if (phase_ != Phase::kIdle) {
    ++ticks_;
    const bool down = mode_ == Mode::kPassive || mode_ == Mode::kDamping || mode_ == Mode::kFault;
    if (phase_ == Phase::kDown && down && upright_) phase_ = Phase::kUp;
    const bool stands = phase_ == Phase::kUp && mode_ == Mode::kStand;
    if (stands || ticks_ > kLongest_ticks || facts.interrupts > 0) phase_ = Phase::kIdle;
  }
  return other_.advance(facts);
}

ModeRequest ReturnToStand::wanted() const noexcept {
  const bool up = phase_ == Phase::kUp;
  switch (mode_) {
    case Mode::kPassive:
      return up ? ModeRequest::kArm : ModeRequest::kNone;
    case Mode::kDamping:
      return up ? ModeRequest::kStand : ModeRequest::kNone;
    case Mode::kFault:
      return up ? ModeRequest::kResetFault : ModeRequest::kNone;
    case Mode::kStandUp:
    case Mode::kStand:
    case Mode::kWalk:
      break;
  }
  return up ? ModeRequest::kNone : ModeRequest::kDamp;
}

}  // namespace sandrunner
