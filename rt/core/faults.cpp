// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/faults.h"

namespace sandrunner {

const char* fault_name(Fault fault) noexcept {
  if (fault == Fault::kNone) return "none";
  for (const FaultRow& row : kFaultTable) {
    if (row.fault == fault) return row.name;
  }
  return "unknown";
}

}  // namespace sandrunner
