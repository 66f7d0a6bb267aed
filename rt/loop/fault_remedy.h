// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/core/faults.h"

namespace sandrunner {

/// What an operator does about a fault, where that is not plain from its name; null: it is. Short:
/// an answer over DDS has 127 characters.
constexpr const char* fault_remedy(Fault fault) noexcept {
  if (fault == Fault::kJointMisplaced) {
    return "fold all legs by hand, reset_fault, arm again; if they are folded: sandrunner check";
  }
  if (fault == Fault::kDrivesCut) return "restart the program";
  return nullptr;
}

}  // namespace sandrunner
