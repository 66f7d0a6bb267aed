// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace sandrunner::evaluate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kNormal975 = 1.959963984540054;

}  // namespace

Estimate rate_interval(int hits, int n) {
  if (n == 0) return {0, kNan, kNan, kNan};
  const double count = n, share = hits / count, z2 = kNormal975 * kNormal975;
  const double middle = (share + z2 / (2.0 * count)) / (1.0 + z2 / count);
  const double half = kNormal975 / (1.0 + z2 / count) *
                      std::sqrt(share * (1.0 - share) / count + z2 / (4.0 * count * count));
  // Exact at the ends, where rounding would leave 1e-17.
  return {n, share, hits == 0 ? 0.0 : middle - half, hits == n ? 1.0 : middle + half};
}

double student_t_975(int degrees) {
  constexpr double kSmall[] = {12.7062, 4.3027, 3.1824, 2.7764, 2.5706};
  if (degrees <= 5) return kSmall[std::max(degrees, 1) - 1];
  // Expansion about the normal quantile (Abramowitz & Stegun 26.7.5).
  const double z = kNormal975, v = degrees;
  const double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4.0 * v) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * v * v) +
         (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * v * v * v);
}

Estimate mean_interval(const std::vector<double>& values) {
  int n = 0;
  double sum = 0.0;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    sum += v;
    ++n;
  }
  if (n == 0) return {0, kNan, kNan, kNan};
  const double mean = sum / n;
  double squares = 0.0;
  for (const double v : values) {
    if (!std::isnan(v)) squares += (v - mean) * (v - mean);
  }
  const double half = n > 1 ? student_t_975(n - 1) * std::sqrt(squares / (n - 1.0) / n) : kNan;
  return {n, mean, mean - half, mean + half};
}

Estimate rms_interval(const std::vector<double>& values) {
  std::vector<double> squares;
  for (const double v : values) squares.push_back(v * v);
  const Estimate e = mean_interval(squares);
  return {e.n, std::sqrt(e.value), std::sqrt(std::max(e.low, 0.0)), std::sqrt(e.high)};
}

double interpolate(std::vector<std::pair<double, double>> points, double x) {
  std::sort(points.begin(), points.end());
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const auto [x0, y0] = points[i];
    const auto [x1, y1] = points[i + 1];
    if (x < x0 || x > x1 || x0 == x1) continue;
    return y0 + (x - x0) / (x1 - x0) * (y1 - y0);
  }
  return kNan;
}

}  // namespace sandrunner::evaluate
