// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tools/bench/report.h"

namespace sandrunner::bench {

/// Steps per second of robots that trot on dry sand, against MuJoCo with the same robot standing.
/// `rounds`: how often each is run, alternately; the ratios are those of one round. Throws
/// std::runtime_error if a robot falls or MuJoCo's does not stand on its four feet: the figures
/// would be of something else.
Report run_batch_bench(int rounds);

}  // namespace sandrunner::bench
