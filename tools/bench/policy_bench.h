// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tools/bench/report.h"

namespace sandrunner::bench {

/// One step of the network (random weights, batch of one): hot, i.e. step after step, and cold,
/// i.e. after a walk that leaves nothing of it in the core's own caches, as at a 100 Hz tick.
/// Next to it: a loop that only loads as many bytes. `rounds`: how often each runs, alternately;
/// ratios are our time over the other's in one round, rates are steps/s. Pins the calling thread
/// and makes it SCHED_FIFO where that is allowed, until it returns.
Report run_policy_bench(int rounds);

}  // namespace sandrunner::bench
