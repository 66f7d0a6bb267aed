// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sandrunner {

/// Prints what this machine allows a real-time process, in words an integrator can act on: kernel
/// and its preemption, frequency governor, limits, isolated processors, throttling, and how late a
/// 4 kHz SCHED_FIFO thread starts over ten seconds.
void print_rt_report();

}  // namespace sandrunner
