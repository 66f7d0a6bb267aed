// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/mode_requests.h"

#include <algorithm>
#include <array>

namespace sandrunner {

bool is_request(std::string_view name) noexcept {
  constexpr std::array<std::string_view, 5> kNames = {"stand", "walk", "stop", "damp",
                                                      "reset_fault"};
  return std::ranges::find(kNames, name) != kNames.end();
}

RequestDecision decide(std::string_view name, Mode mode, bool can_walk) noexcept {
  if (name == "damp") return {.request = ModeRequest::kDamp, .calms = true};
  if (name == "stop") {
    return {.request = mode == Mode::kWalk ? ModeRequest::kStand : ModeRequest::kNone,
            .calms = true};
  }
  if (name == "reset_fault") {
    if (mode != Mode::kFault) return {.refusal = "no fault is latched"};
    return {.request = ModeRequest::kResetFault};
  }
  if (mode == Mode::kFault) return {.refusal = "a fault is latched, reset_fault comes first"};
  if (name == "stand") return {.request = ModeRequest::kStand};
  if (!can_walk) return {.refusal = "no policy to walk with"};
  if (mode != Mode::kStand && mode != Mode::kWalk) {
    return {.refusal = "the robot does not stand, stand comes first"};
  }
  return {.request = ModeRequest::kWalk};
}

const char* failure(ModeRequest request, Mode after) noexcept {
  switch (request) {
    case ModeRequest::kNone:
    case ModeRequest::kPassive:  // which nobody can request
      return nullptr;
    case ModeRequest::kStand:
      if (after == Mode::kStandUp || after == Mode::kStand || after == Mode::kWalk) return nullptr;
      break;
    case ModeRequest::kWalk:
      if (after == Mode::kWalk) return nullptr;
      break;
    case ModeRequest::kDamp:
      // A fault damps too, then switches the drives off.
      if (after == Mode::kDamping || after == Mode::kFault) return nullptr;
      break;
    case ModeRequest::kResetFault:
      if (after != Mode::kFault) return nullptr;
      return "the fault still holds, or the drives are still damping";
  }
  return after == Mode::kFault ? "a fault came up" : "the controller did not follow";
}

}  // namespace sandrunner
