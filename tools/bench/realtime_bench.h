// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tools/bench/report.h"

namespace sandrunner::bench {

/// How long a reading thread is held up by the exchange of a 400-byte record with a writer that
/// never rests: our triple buffer's 99.9th percentile over that of the same record behind a
/// std::mutex, `rounds` pairs in turn, both threads SCHED_FIFO (where permitted) on a processor of
/// their own. Adds `triple_buffer_p999_vs_mutex`.
void run_exchange_bench(int rounds, Report& report);

/// What it costs the control thread to hand a tick to telemetry and recording. Adds
/// `tick_handover_p50_ns` and `tick_handover_p99_ns`, which have one reading of the clock in them,
/// and `clock_p50_ns`.
void run_handover_bench(int rounds, Report& report);

/// How late a 4 kHz thread starts its ticks: the control thread of a real-time run (robot walking
/// on dry sand, policy thread beside it) over cyclictest with the same priority, interval and
/// processor, `rounds` pairs in turn. A slot missed altogether is no sample, for either. Adds
/// `pd_p50_vs_cyclictest` and `pd_p99_vs_cyclictest`. Throws InputError if cyclictest (Debian
/// package rt-tests) is missing or may not run.
void run_wakeup_bench(int rounds, Report& report);

}  // namespace sandrunner::bench
