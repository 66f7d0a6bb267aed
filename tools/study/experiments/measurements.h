// SPDX-License-Identifier: BSD-3-Clause
// Runs the experiments that are asked for, or takes them from the run before that was killed.
#pragma once

#include <string>

#include "tools/study/evidence/evidence.h"
#include "tools/study/experiments/models.h"
#include "tools/study/experiments/options.h"

namespace sandrunner::study {

/// Measures each model in each chosen experiment, and reads the benchmark's file if there is one.
/// Each measurement is kept in OUT/cache/EXPERIMENT-NAME-SEED.json and taken from there if model,
/// settings and program are the same. Prints a line for each experiment. Throws InputError.
Evidence measure(const Options& options, const std::vector<Model>& models);

/// Reads what `sandrunner-bench contact --json` wrote. Throws InputError.
ContactBench read_contact_bench(const std::string& path);

/// results.json: all measurements.
std::string results_json(const Options& options, const std::vector<Model>& models,
                         const Evidence& evidence);

}  // namespace sandrunner::study
