// SPDX-License-Identifier: BSD-3-Clause
// The terms of CLAIMS.md: what "above", "about", "share" and "excess" mean, and the verdicts.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace sandrunner::study {

enum class Verdict { kAgrees, kContradicts, kCannotTell, kNotTestable };
/// "agrees", "contradicts", "can't tell", "not testable in simulation"
const char* verdict_name(Verdict verdict) noexcept;

/// A figure of a controller: for each training seed its value, and what each run had of it. Runs
/// with the same place in the list have the same start and noise for every controller; nan: none.
struct SeedValue {
  double value = 0.0;
  std::vector<double> runs = {};
};
using Figure = std::map<int, SeedValue>;

/// The median over the seeds; nan for a figure without seeds or with one that is nan.
double median(const Figure& figure);
/// "1.23 [1.10, 1.30]", or "1.23" for one seed, values times `scale`; "not defined" for nan.
std::string printed(const Figure& figure, double scale, int digits);

/// Least number of pairs of runs that a comparison may rest on.
inline constexpr int kLeastPairs = 8;

struct Comparison {
  bool holds = false;
  int pairs = 0;  ///< of runs of the first common seed in which both have the figure
};
/// A above B by m: each seed's value of A exceeds each seed's of B by more than m, and for the
/// first common seed the 95 % interval of the paired difference of runs lies above 0, with at
/// least kLeastPairs pairs.
Comparison above(const Figure& a, const Figure& b, double margin = 0.0);
/// The same with a margin of this share of B's value.
Comparison above_by_share(const Figure& a, const Figure& b, double share);

/// A below B by this share of B's value, in the same sense.
Comparison below_by_share(const Figure& a, const Figure& b, double share);

/// The median is within this share of x.
bool is_about(const Figure& figure, double x, double share = 0.15);
/// Every seed is off by more than twice that share.
bool is_far_from(const Figure& figure, double x, double share = 0.15);
/// The median is within 15 percentage points of x; every seed is off by more than 30.
bool is_share(const Figure& figure, double x);
bool is_far_from_share(const Figure& figure, double x);
/// A over B, seed by seed.
Figure ratio(const Figure& a, const Figure& b);
/// Median of A over median of B, less 1.
double excess(const Figure& a, const Figure& b);
/// Kendall's tau of two orders of the same things: 1 if they agree, -1 if one is the other
/// reversed.
double kendall_tau(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace sandrunner::study
