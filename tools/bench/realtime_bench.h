// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tools/bench/report.h"

namespace sandrunner::bench {

/// How late a 4 kHz thread starts its ticks: the control thread of a real-time run (robot walking
/// on dry sand, policy thread beside it) over cyclictest with the same priority, interval and
/// processor, `rounds` alternating pairs. A slot missed altogether is no sample, for either. Adds
/// `pd_p50_vs_cyclictest` and `pd_p99_vs_cyclictest`. Throws InputError if cyclictest (Debian
/// package rt-tests) is missing or may not run.
void run_wakeup_bench(int rounds, Report& report);

}  // namespace sandrunner::bench
