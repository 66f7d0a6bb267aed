// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/analysis/neighbours.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <map>
#include <numbers>

#include "rt/base/quantile.h"
#include "sim/lanes/random.h"

namespace sandrunner::study {
namespace {

std::complex<double> on_circle(double phase) {
  return std::polar(1.0, 2.0 * std::numbers::pi * phase);
}

}  // namespace

std::vector<std::vector<int>> neighbours_in_other_runs(const States& states, int count) {
  const auto n = static_cast<int>(states.points.rows());
  std::vector<std::vector<int>> all;
  for (int i = 0; i < n; ++i) {
    const Eigen::ArrayXd d =
        (states.points.rowwise() - states.points.row(i)).square().rowwise().sum();
    std::vector<int> others;
    for (int j = 0; j < n; ++j) {
      if (states.run[j] != states.run[i]) others.push_back(j);
    }
    const auto most = std::min<std::ptrdiff_t>(count, static_cast<std::ptrdiff_t>(others.size()));
    std::partial_sort(others.begin(), others.begin() + most, others.end(),
                      [&](int a, int b) { return d(a) < d(b) || (d(a) == d(b) && a < b); });
    others.resize(static_cast<std::size_t>(most));
    all.push_back(std::move(others));
  }
  return all;
}

double share_told(const States& states, const std::vector<std::vector<int>>& neighbours,
                  const std::vector<int>& ground) {
  int right = 0;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    std::map<int, int> votes;
    for (const int j : neighbours[i]) ++votes[ground[states.run[j]]];
    int told = -1, most = 0;
    for (const int j : neighbours[i]) {  // from the nearest on
      const int candidate = ground[states.run[j]];
      if (votes[candidate] > most) {
        most = votes[candidate];
        told = candidate;
      }
    }
    right += told == ground[states.run[i]];
  }
  return right / static_cast<double>(neighbours.size());
}

double shuffled_share_told(const States& states, const std::vector<std::vector<int>>& neighbours) {
  constexpr std::uint64_t kTimes = 100, kStream = 31;
  std::vector<double> shares;
  std::vector<int> ground = states.ground;
  for (std::uint64_t time = 0; time < kTimes; ++time) {
    for (std::size_t i = ground.size(); i > 1; --i) {
      const auto j = static_cast<std::size_t>(static_cast<double>(i) *
                                              sim::random_uniform(1, kStream, 1000 * time + i));
      std::swap(ground[i - 1], ground[j]);
    }
    shares.push_back(share_told(states, neighbours, ground));
  }
  std::sort(shares.begin(), shares.end());
  return quantile(shares, 0.95);
}

double phase_told(const States& states, const std::vector<std::vector<int>>& neighbours) {
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    std::complex<double> told = 0.0;
    for (const int j : neighbours[i]) told += on_circle(states.phase[j]);
    if (std::abs(told) > 0.0) sum += told / std::abs(told) * std::conj(on_circle(states.phase[i]));
  }
  return std::abs(sum) / static_cast<double>(neighbours.size());
}

}  // namespace sandrunner::study
