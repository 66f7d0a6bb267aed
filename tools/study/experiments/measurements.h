// SPDX-License-Identifier: BSD-3-Clause
// Runs the experiments that are asked for, or takes them from the run before that was killed.
#pragma once

#include "tools/study/experiments/models.h"
#include "tools/study/experiments/options.h"
#include "tools/study/experiments/runs.h"

namespace sandrunner::study {

/// Part of the key of each measurement in the cache. Raise it with every change of the simulator,
/// an experiment or the format after which a measurement may be another.
inline constexpr int kMeasurementVersion = 3;

/// Measures each model in each chosen experiment. Each measurement is kept in
/// OUT/cache/EXPERIMENT-NAME-SEED.json and taken from there if model, settings and
/// kMeasurementVersion are the same. Prints a line for each experiment. Throws InputError.
Measurements measure(const Options& options, const std::vector<Model>& models);

}  // namespace sandrunner::study
