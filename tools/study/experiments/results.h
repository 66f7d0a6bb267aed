// SPDX-License-Identifier: BSD-3-Clause
// results.json: all that ../page makes tables, figures and verdicts from.
#pragma once

#include <vector>

#include "tools/study/experiments/models.h"
#include "tools/study/experiments/options.h"
#include "tools/study/experiments/runs.h"

namespace sandrunner::study {

/// Writes results.json, and of E2 the run of Fig. 2 A: recovery.csv and recovery.html. Throws
/// InputError if a file cannot be written. `contact`: read_contact_bench, or null.
///   build, command (without --out and --threads), runs, grid_runs, grid_cells
///   models    by name: controller, seed, hash of the file, provenance, length of the training in
///             transitions, settings that differ from the usual ones, learning curve by column
///   takes_part    the controllers of each experiment
///   experiments   [experiment][controller][seed]: groups of runs (runs.h)
///   contact       null without --contact
///   recovery_run  null without one: number of its start, seed of the model, time of the touchdown,
///   curves ground        the contact law against published experiments: anchors, and drops of a
///   ball
void write_results(const Options& options, const std::vector<Model>& models,
                   const Measurements& measurements, const Json& contact);

}  // namespace sandrunner::study
