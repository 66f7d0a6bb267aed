// SPDX-License-Identifier: BSD-3-Clause
// What a benchmark found, as a table and as JSON.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/bench/quartiles.h"

namespace sandrunner::bench {

struct Report {
  std::vector<std::pair<std::string, std::string>> facts;  ///< what was measured, on what
  std::vector<std::pair<std::string, Quartiles>> rates;    ///< steps/s, or as the name says
  std::vector<std::pair<std::string, Quartiles>> ratios;   ///< of rates of the same round
};

void print(const Report& report);

std::string to_json(const Report& report);

}  // namespace sandrunner::bench
