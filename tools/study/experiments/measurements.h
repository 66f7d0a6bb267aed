// SPDX-License-Identifier: BSD-3-Clause
// Runs the experiments that are asked for, or takes them from the run before that was killed.
#pragma once

#include "tools/study/experiments/models.h"
#include "tools/study/experiments/options.h"
#include "tools/study/experiments/runs.h"

namespace sandrunner::study {

/// Measures each model in each chosen experiment. Each measurement is kept in
/// OUT/cache/EXPERIMENT-NAME-SEED.json and taken from there if model, settings and program are the
/// same. Prints a line for each experiment. Throws InputError.
Measurements measure(const Options& options, const std::vector<Model>& models);

}  // namespace sandrunner::study
