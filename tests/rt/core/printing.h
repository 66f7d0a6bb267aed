// SPDX-License-Identifier: BSD-3-Clause
// Modes and faults by their names in messages of GoogleTest.
#pragma once

#include <ostream>

#include "rt/core/mode_machine.h"
#include "rt/core/safety_gate.h"

namespace sandrunner {

inline void PrintTo(Mode mode, std::ostream* out) { *out << mode_name(mode); }
inline void PrintTo(Fault fault, std::ostream* out) { *out << fault_name(fault); }

}  // namespace sandrunner
