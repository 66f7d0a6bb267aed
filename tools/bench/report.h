// SPDX-License-Identifier: BSD-3-Clause
// What a benchmark found, as a table and as JSON.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rt/core/log_histogram.h"

namespace sandrunner::bench {

/// Median and quartiles of what the rounds gave.
struct Quartiles {
  double median = 0.0, q1 = 0.0, q3 = 0.0;
  std::size_t runs = 0;
};

/// Quartiles of at least one value, linear between neighbours.
Quartiles quartiles(std::vector<double> values);

/// What each candidate had in each round.
using Samples = std::map<std::string, std::vector<double>>;

/// A share of durations, 0..1, and its name: {"p99", 0.99}.
using Percentile = std::pair<const char*, double>;

/// Adds what a round gave of these: `name`_p99_us and so on, in us.
void add_percentiles(Samples& samples_us, const std::string& name, const LogHistogram& times,
                     std::span<const Percentile> percentiles);

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
