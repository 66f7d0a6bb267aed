// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/mode_requests.h"

namespace sandrunner {
namespace {

constexpr const char* kFaultLatched = "a fault is latched, reset_fault comes first";

}  // namespace

std::optional<Wish> wish_from(std::string_view text) noexcept {
  if (text == "stand") return Wish::kStand;
  if (text == "walk") return Wish::kWalk;
  if (text == "stop") return Wish::kStop;
  if (text == "damp") return Wish::kDamp;
  if (text == "reset_fault") return Wish::kResetFault;
  return std::nullopt;
}

WishDecision decide(Wish wish, Mode mode, bool can_walk) noexcept {
  switch (wish) {
    case Wish::kStand:
      if (mode == Mode::kFault) return {.refusal = kFaultLatched};
      return {.request = ModeRequest::kStand};
    case Wish::kWalk:
      if (mode == Mode::kFault) return {.refusal = kFaultLatched};
      if (!can_walk) return {.refusal = "no policy to walk with"};
      if (mode != Mode::kStand && mode != Mode::kWalk) {
        return {.refusal = "the robot does not stand, stand comes first"};
      }
      return {.request = ModeRequest::kWalk};
    case Wish::kStop:
      return {.request = mode == Mode::kWalk ? ModeRequest::kStand : ModeRequest::kNone};
    case Wish::kDamp:
      return {.request = ModeRequest::kDamp};
    case Wish::kResetFault:
      if (mode != Mode::kFault) return {.refusal = "no fault is latched"};
      return {.request = ModeRequest::kResetFault};
  }
  return {.refusal = "unknown request"};
}

const char* failure(Wish wish, Mode after) noexcept {
  switch (wish) {
    case Wish::kStand:
      if (after == Mode::kStandUp || after == Mode::kStand || after == Mode::kWalk) return nullptr;
      break;
    case Wish::kWalk:
      if (after == Mode::kWalk) return nullptr;
      break;
    case Wish::kStop:
      return nullptr;
    case Wish::kDamp:
      // A fault damps too, then switches the drives off.
      if (after == Mode::kDamping || after == Mode::kFault) return nullptr;
      break;
    case Wish::kResetFault:
      if (after != Mode::kFault) return nullptr;
      return "the fault still holds, or the drives are still damping";
  }
  return after == Mode::kFault ? "a fault came up" : "the controller did not follow";
}

}  // namespace sandrunner
