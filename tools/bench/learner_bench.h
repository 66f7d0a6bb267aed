// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tools/bench/report.h"

namespace sandrunner::bench {

/// The matrix products of the training that ships, of all layers: forward, backward to the inputs,
/// and the weights' gradients; the learner's kernels for AVX-512 and AVX2, and the same with Eigen.
/// One core; rates in GFLOP/s (a multiplication and an addition are two), beside those of fused
/// multiply-adds on registers alone. `rounds`: how often each is run, alternately; ratios are of
/// one round. Throws std::runtime_error if the results disagree.
Report run_learner_bench(int rounds);

}  // namespace sandrunner::bench
