// SPDX-License-Identifier: BSD-3-Clause
// The measurements of sandrunner-bench. Each runs its candidates `rounds` times, alternately;
// ratios are of one round.
#pragma once

#include <string>

#include "tools/bench/report.h"

namespace sandrunner::bench {

/// Steps per second of robots that trot on dry sand, against MuJoCo with the same robot standing.
/// Throws std::runtime_error if a robot falls or MuJoCo's does not stand on its four feet: the
/// figures would be of something else.
Report run_batch_bench(int rounds);

/// The matrix products of the training that ships, of all layers: forward, backward to the inputs,
/// and the weights' gradients; the learner's kernels for AVX-512 and AVX2, and the same with Eigen.
/// One core; rates in GFLOP/s (a multiplication and an addition are two), beside those of fused
/// multiply-adds on registers alone. Throws std::runtime_error if the results disagree.
Report run_learner_bench(int rounds);

/// One step of the network (random weights, batch of one): hot, i.e. step after step, and cold,
/// i.e. after a walk that leaves nothing of it in the core's own caches, as at a 100 Hz tick.
/// Next to it: a loop that only loads as many bytes. Ratios are our time over the other's, rates
/// are steps/s. Pins the calling thread and makes it SCHED_FIFO where that is allowed, until it
/// returns.
Report run_policy_bench(int rounds);

/// How late a 4 kHz thread starts its ticks: the control thread of a real-time run (robot walking
/// on dry sand, with its policy thread) over cyclictest with the same priority, interval and
/// processor, `rounds` alternating pairs. A slot missed altogether is no sample, for either. Adds
/// `pd_p50_vs_cyclictest` and `pd_p99_vs_cyclictest`. Throws InputError if cyclictest (Debian
/// package rt-tests) is missing or may not run.
void run_wakeup_bench(int rounds, Report& report);

/// How long the control thread's ticks take when it drives a Unitree robot over DDS, over those of
/// the same run without DDS: the same controller, policy and terrain, in `rounds` pairs of runs.
/// The robot over DDS is `sandrunner-hil` on loopback, the one without is simulated in a thread
/// next to the control thread. `hardware`: a file of kind unitree; its interface is taken to be lo.
/// The process may not have a second thread. Throws InputError.
Report run_unitree_bench(const std::string& hardware, int rounds);

}  // namespace sandrunner::bench
