// SPDX-License-Identifier: BSD-3-Clause
// What a benchmark found, as a table and as JSON.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tools/bench/quartiles.h"

namespace sandrunner::bench {

/// What each candidate had in each round.
using Samples = std::map<std::string, std::vector<double>>;

struct Report {
  std::vector<std::pair<std::string, std::string>> facts;  ///< what was measured, on what
  std::vector<std::pair<std::string, Quartiles>> rates;    ///< steps/s, or as the name says
  std::vector<std::pair<std::string, Quartiles>> ratios;   ///< of rates of the same round
};

/// Adds samples[above] over samples[below], round by round; nothing if `above` was not run.
void add_ratio(Report& report, const std::string& name, const Samples& samples,
               const std::string& above, const std::string& below);

void print(const Report& report);

std::string to_json(const Report& report);

}  // namespace sandrunner::bench
