// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/mode_requests.h"

#include "rt/core/mode_machine.h"

namespace sandrunner {

std::string request_names() {
  std::string names;
  for (const RequestRow& row : kRequestTable) {
    if (&row != &kRequestTable.front()) names += &row == &kRequestTable.back() ? " or " : ", ";
    names += row.name;
  }
  return names;
}

RequestDecision decide(std::string_view name, Mode mode, const char* no_walk) noexcept {
  const RequestRow* const row = request_named(name);
  if (!row) return {.refusal = "unknown"};
  const auto unless = [&](const char* refusal) {
    return RequestDecision{.request = refusal ? ModeRequest::kNone : row->request,
                           .calms = row->calms,
                           .refusal = refusal};
  };
  if (row->calms) return unless(nullptr);
  if (row->request == ModeRequest::kResetFault) {
    return unless(mode == Mode::kFault ? nullptr : "no fault is latched");
  }
  if (mode == Mode::kFault) return unless("a fault is latched, reset_fault comes first");
  const bool off = mode == Mode::kPassive;
  switch (row->request) {
    case ModeRequest::kArm:
      return unless(off ? nullptr : "the drives are on already");
    case ModeRequest::kStand:
      return unless(off ? "the drives are off, arm comes first" : nullptr);
    case ModeRequest::kLie:
      return unless(off ? "the drives are off" : nullptr);
    case ModeRequest::kPassive:
      return unless(off                      ? "the drives are off already"
                    : mode == Mode::kDamping ? nullptr
                                             : "the robot carries itself, lie comes first");
    case ModeRequest::kWalk:
      if (no_walk) return unless(no_walk);
      if (mode == Mode::kStandUp) {
        return unless("the robot is still standing up, try again when it stands");
      }
      return unless(mode == Mode::kStand || mode == Mode::kWalk
                        ? nullptr
                        : "the robot does not stand, stand comes first");
    case ModeRequest::kNone:
    case ModeRequest::kDamp:
    case ModeRequest::kStop:
    case ModeRequest::kResetFault:
      break;
  }
  return unless(nullptr);
}

bool calms(std::string_view name) noexcept {
  const RequestRow* const row = request_named(name);
  return row && row->calms;
}

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
