// SPDX-License-Identifier: BSD-3-Clause
// Means, rates and their 95 % confidence intervals.
#pragma once

#include <utility>
#include <vector>

namespace sandrunner::evaluate {

/// A figure with its 95 % confidence interval. n = 0: no run has the figure, the rest is nan.
struct Estimate {
  int n = 0;
  double value = 0.0, low = 0.0, high = 0.0;
};

/// Share of `hits` among n; Wilson's score interval (Wilson 1927), which stays sensible at 0 and n.
Estimate rate_interval(int hits, int n);

/// Mean with Student's t interval, for independent values that are close to normally distributed.
/// nan values are left out. One value has no interval: its bounds are nan.
Estimate mean_interval(const std::vector<double>& values);

/// Square root of the mean of the squares; the interval is that of the mean square.
Estimate rms_interval(const std::vector<double>& values);

/// 0.975 quantile of Student's t with this many degrees of freedom (>= 1), to 0.2 %.
double student_t_975(int degrees);

/// Value at x by straight lines between points (x, y) in any order; nan outside of them.
double interpolate(std::vector<std::pair<double, double>> points, double x);

}  // namespace sandrunner::evaluate
