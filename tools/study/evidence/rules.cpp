// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/evidence/rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "tools/evaluate/statistics.h"
#include "tools/study/evidence/runs.h"

namespace sandrunner::study {
namespace {

std::vector<double> values_of(const Figure& figure) {
  std::vector<double> values;
  for (const auto& [seed, value] : figure) values.push_back(value.value);
  return values;
}

bool every_seed(const Figure& figure, const std::function<bool(double)>& condition) {
  const std::vector<double> values = values_of(figure);
  return !values.empty() && std::all_of(values.begin(), values.end(), condition);
}

Comparison compare(const Figure& a, const Figure& b,
                   const std::function<bool(double a, double b)>& exceeds) {
  Comparison result;
  for (const auto& [seed, of_a] : a) {
    const auto of_b = b.find(seed);
    if (of_b == b.end()) continue;
    std::vector<double> differences;
    const std::vector<double>&x = of_a.runs, &y = of_b->second.runs;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
      differences.push_back(x[i] - y[i]);  // nan if one of them is
    }
    const evaluate::Estimate mean = evaluate::mean_interval(differences);
    result.pairs = mean.n;
    result.holds = mean.n >= kLeastPairs && mean.low > 0.0;
    break;
  }
  for (const double x : values_of(a)) {
    for (const double y : values_of(b)) result.holds = result.holds && exceeds(x, y);
  }
  return result;
}

}  // namespace

const char* verdict_name(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kAgrees:
      return "agrees";
    case Verdict::kContradicts:
      return "contradicts";
    case Verdict::kCannotTell:
      return "can't tell";
    case Verdict::kNotTestable:
      return "not testable in simulation";
  }
  return "";
}

double median(const Figure& figure) { return median_of(values_of(figure)); }

std::string printed(const Figure& figure, double scale, int digits) {
  const double middle = median(figure);
  if (std::isnan(middle)) return "not defined";
  std::string text = fmt::format("{:.{}f}", scale * middle, digits);
  if (figure.size() > 1) {
    const std::vector<double> values = values_of(figure);
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
    text += fmt::format(" [{:.{}f}, {:.{}f}]", scale * *least, digits, scale * *greatest, digits);
  }
  return text;
}

Comparison above(const Figure& a, const Figure& b, double margin) {
  return compare(a, b, [=](double x, double y) { return x - y > margin; });
}

Comparison above_by_share(const Figure& a, const Figure& b, double share) {
  return compare(a, b, [=](double x, double y) { return x - y > share * std::fabs(y); });
}

Comparison below_by_share(const Figure& a, const Figure& b, double share) {
  return compare(b, a, [=](double x, double y) { return x - y > share * std::fabs(x); });
}

bool is_about(const Figure& figure, double x, double share) {
  return std::fabs(median(figure) - x) <= share * x;
}

bool is_far_from(const Figure& figure, double x, double share) {
  return every_seed(figure, [=](double v) { return std::fabs(v - x) > 2.0 * share * x; });
}

bool is_share(const Figure& figure, double x) { return std::fabs(median(figure) - x) <= 0.15; }

bool is_far_from_share(const Figure& figure, double x) {
  return every_seed(figure, [=](double v) { return std::fabs(v - x) > 0.30; });
}

Figure ratio(const Figure& a, const Figure& b) {
  Figure result;
  for (const auto& [seed, value] : a) result[seed] = {value.value / b.at(seed).value};
  return result;
}

double excess(const Figure& a, const Figure& b) { return median(a) / median(b) - 1.0; }

double kendall_tau(const std::vector<double>& a, const std::vector<double>& b) {
  int sum = 0, pairs = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = i + 1; j < a.size(); ++j) {
      const double product = (a[i] - a[j]) * (b[i] - b[j]);
      sum += (product > 0.0) - (product < 0.0);
      ++pairs;
    }
  }
  return sum / static_cast<double>(pairs);
}

}  // namespace sandrunner::study
