// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tools/bench/report.h"

namespace sandrunner::bench {

/// How long the control thread's ticks take when it drives a Unitree robot over DDS, over those of
/// the same run without DDS: the same controller, policy and terrain, in `rounds` pairs of runs.
/// The robot over DDS is `sandrunner-hil` on loopback, the one without is simulated in a thread
/// beside the control thread. `hardware`: a file of kind unitree; its interface is taken to be lo.
/// The process may not have a second thread. Throws InputError.
Report run_unitree_bench(const std::string& hardware, int rounds);

}  // namespace sandrunner::bench
