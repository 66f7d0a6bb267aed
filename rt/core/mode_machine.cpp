// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/mode_machine.h"

namespace sandrunner {

const RequestRow* row_of(ModeRequest request) noexcept {
  for (const RequestRow& row : kRequestTable) {
    if (row.request == request) return &row;
  }
  return nullptr;
}

const RequestRow* request_named(std::string_view name) noexcept {
  for (const RequestRow& row : kRequestTable) {
    if (row.name == name) return &row;
  }
  return nullptr;
}

Mode next_mode(Mode mode, Event event) noexcept {
  for (const Transition& transition : kTransitions) {
    if (transition.from == mode && transition.event == event) return transition.to;
  }
  return mode;
}

const char* mode_name(Mode mode) noexcept {
  switch (mode) {
    case Mode::kPassive:
      return "passive";
    case Mode::kDamping:
      return "damping";
    case Mode::kStandUp:
      return "stand_up";
    case Mode::kStand:
      return "stand";
    case Mode::kWalk:
      return "walk";
    case Mode::kFault:
      return "fault";
  }
  return "unknown";
}

}  // namespace sandrunner
