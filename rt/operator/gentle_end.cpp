// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/gentle_end.h"

namespace sandrunner {

ModeRequest GentleEnd::lie() noexcept {
  if (begun_) return ModeRequest::kNone;
  begun_ = true;
  return ModeRequest::kLie;
}

ModeRequest GentleEnd::damp() noexcept {
  if (damps_) return ModeRequest::kNone;
  begun_ = damps_ = true;
  return ModeRequest::kDamp;
}

ModeRequest GentleEnd::advance(Mode mode, std::uint64_t ticks) noexcept {
  if (!begun_) return ModeRequest::kNone;
  ticks_ += ticks;
  const bool down = mode == Mode::kDamping || mode == Mode::kFault || mode == Mode::kPassive;
  if (damps_ || down) damped_ticks_ += ticks;
  // Drives that are off need no damping.
  done_ = mode == Mode::kPassive || damped_ticks_ >= kDampingEnd_ticks;
  return !down && ticks_ >= kLongestEnd_ticks ? damp() : ModeRequest::kNone;
}

}  // namespace sandrunner
