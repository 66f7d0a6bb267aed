// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/mode_requests.h"

#include <algorithm>

namespace sandrunner {

bool is_request(std::string_view name) noexcept {
  return std::ranges::find(kRequests, name) != kRequests.end();
}

RequestDecision decide(std::string_view name, Mode mode, const char* no_walk) noexcept {
  if (name == "damp") return {.request = ModeRequest::kDamp, .calms = true};
  if (name == "stop") return {.request = ModeRequest::kStop, .calms = true};
  if (name == "reset_fault") {
    if (mode != Mode::kFault) return {.refusal = "no fault is latched"};
    return {.request = ModeRequest::kResetFault};
  }
  if (mode == Mode::kFault) return {.refusal = "a fault is latched, reset_fault comes first"};
  if (name == "arm") {
    if (mode != Mode::kPassive) return {.refusal = "the drives are on already"};
    return {.request = ModeRequest::kArm};
  }
  if (name == "stand") {
    if (mode == Mode::kPassive) return {.refusal = "the drives are off, arm comes first"};
    return {.request = ModeRequest::kStand};
  }
  if (name == "lie") {
    if (mode == Mode::kPassive) return {.refusal = "the drives are off"};
    return {.request = ModeRequest::kLie};
  }
  if (name == "disarm") {
    if (mode == Mode::kPassive) return {.refusal = "the drives are off already"};
    if (mode != Mode::kDamping) return {.refusal = "the robot carries itself, lie comes first"};
    return {.request = ModeRequest::kPassive};
  }
  if (no_walk) return {.refusal = no_walk};
  if (mode == Mode::kStandUp) {
    return {.refusal = "the robot is still standing up, try again when it stands"};
  }
  if (mode != Mode::kStand && mode != Mode::kWalk) {
    return {.refusal = "the robot does not stand, stand comes first"};
  }
  return {.request = ModeRequest::kWalk};
}

bool calms(std::string_view name) noexcept { return decide(name, Mode::kPassive, nullptr).calms; }

const char* failure(ModeRequest request, Mode after) noexcept {
  switch (request) {
    case ModeRequest::kNone:
    case ModeRequest::kStop:  // whatever moved is ending
    case ModeRequest::kLie:
      return nullptr;
    case ModeRequest::kArm:
      if (after == Mode::kDamping) return nullptr;
      break;
    case ModeRequest::kStand:
      if (after == Mode::kStandUp || after == Mode::kStand || after == Mode::kWalk) return nullptr;
      break;
    case ModeRequest::kWalk:
      if (after == Mode::kWalk) return nullptr;
      if (after == Mode::kStand) return "the robot is lying down, stand comes first";
      break;
    case ModeRequest::kPassive:
      if (after == Mode::kPassive) return nullptr;
      break;
    case ModeRequest::kDamp:
      // A fault damps too, then switches the drives off; in Passive they are.
      if (after == Mode::kDamping || after == Mode::kFault || after == Mode::kPassive) {
        return nullptr;
      }
      break;
    case ModeRequest::kResetFault:
      if (after != Mode::kFault) return nullptr;
      return "the fault still holds, or the drives are still damping";
  }
  return after == Mode::kFault ? "a fault came up" : "the controller did not follow";
}

}  // namespace sandrunner
