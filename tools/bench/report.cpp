// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "rt/base/quantile.h"

namespace sandrunner::bench {

Quartiles quartiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.5), quantile(values, 0.25), quantile(values, 0.75), values.size()};
}

void add_percentiles(Samples& samples_us, const std::string& name, const LogHistogram& times,
                     std::span<const Percentile> percentiles) {
  for (const auto& [percentile, share] : percentiles) {
    samples_us[fmt::format("{}_{}_us", name, percentile)].push_back(
        1e-3 * static_cast<double>(times.quantile_ns(share)));
  }
}

void add_ratio(Report& report, const std::string& name, const Samples& samples,
               const std::string& above, const std::string& below) {
  if (!samples.contains(above)) return;
  std::vector<double> ratios = samples.at(above);
  for (std::size_t i = 0; i < ratios.size(); ++i) ratios[i] /= samples.at(below)[i];
  report.ratios.emplace_back(name, quartiles(ratios));
}

void print(const Report& report) {
  for (const auto& [name, text] : report.facts) fmt::print("{:<12}{}\n", name, text);
  fmt::print("\n{:<32}{:>12}{:>12}{:>12}{:>7}\n", "steps/s or as named", "median", "q1", "q3",
             "runs");
  for (const auto& [name, q] : report.rates) {
    fmt::print("{:<32}{:>12.5g}{:>12.5g}{:>12.5g}{:>7}\n", name, q.median, q.q1, q.q3, q.runs);
  }
  fmt::print("\n{:<32}{:>12}{:>12}{:>12}{:>7}\n", "ratio", "median", "q1", "q3", "runs");
  for (const auto& [name, q] : report.ratios) {
    fmt::print("{:<32}{:>12.3f}{:>12.3f}{:>12.3f}{:>7}\n", name, q.median, q.q1, q.q3, q.runs);
  }
}

std::string to_json(const Report& report) {
  nlohmann::ordered_json json;
  for (const auto& [name, text] : report.facts) json[name] = text;
  const auto values = [](const Quartiles& q) {
    return nlohmann::ordered_json{
        {"median", q.median}, {"q1", q.q1}, {"q3", q.q3}, {"runs", q.runs}};
  };
  for (const auto& [name, q] : report.ratios) json[name] = values(q);
  for (const auto& [name, q] : report.rates) json["rates"][name] = values(q);
  return json.dump(2) + '\n';
}

}  // namespace sandrunner::bench
