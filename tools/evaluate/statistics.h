// SPDX-License-Identifier: BSD-3-Clause
// Means, rates and their 95 % confidence intervals.
#pragma once

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
/// nan values are left out. One value: the interval is the value itself.
Estimate mean_interval(const std::vector<double>& values);

/// Square root of the mean of the squares; the interval is that of the mean square.
Estimate rms_interval(const std::vector<double>& values);

/// 0.975 quantile of Student's t with this many degrees of freedom (>= 1), to 0.2 %.
double student_t_975(int degrees);

/// Quantile at `share` in [0, 1] of ascending values, linear between them. nan if there are none.
double quantile(const std::vector<double>& sorted, double share);

}  // namespace sandrunner::evaluate
