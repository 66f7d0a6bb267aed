// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tools/study/evidence/evidence.h"
#include "tools/study/experiments/models.h"
#include "tools/study/experiments/options.h"

namespace sandrunner::study {

/// Writes all that a study leaves: report.html with everything in it, results.json, claims.csv,
/// figures/*.png and recovery.html. Throws InputError if a file cannot be written.
void write_report(const Options& options, const std::vector<Model>& models,
                  const Evidence& evidence);

}  // namespace sandrunner::study
