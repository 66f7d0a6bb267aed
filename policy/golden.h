// SPDX-License-Identifier: BSD-3-Clause
// The golden example of a policy file: inputs and outputs of the network, computed by other code
// than `Network`, and run again whenever the file is loaded.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "policy/network.h"
#include "policy/text.h"

namespace sandrunner {

inline constexpr int kGoldenSteps = 50;
/// Allowed deviation of an output, relative to max(1, |expected output|).
inline constexpr double kGoldenTolerance = 1e-4;

/// kGoldenSteps steps, one after the other from the zero state; row-major.
struct GoldenExample {
  std::vector<float> observation;   ///< (kGoldenSteps, kObservationSize), raw
  std::vector<float> action;        ///< (kGoldenSteps, kNumJoints), the actor's output
  std::vector<float> estimate_raw;  ///< (kGoldenSteps, kEstimateSize), the estimator's output
  std::vector<float> insight;       ///< (kGoldenSteps, kInsightSize), if a network sees it
};

/// Observations spread around the mean as the variance says, some beyond the clip, with the outputs
/// that a plain double-precision evaluation gives.
GoldenExample make_golden_example(const NetworkParameters& parameters);

/// Runs the example through `network` and returns the largest deviation of an output, relative to
/// max(1, |expected output|). Throws InputError ("<file>: golden example fails at step ...") if it
/// exceeds kGoldenTolerance.
double check_golden_example(const std::string& file, const Network& network,
                            const GoldenExample& golden);
/// The same with the network of these parameters; in double precision if it sees the insight, which
/// `Network` does not.
double check_golden_example(const std::string& file, const NetworkParameters& parameters,
                            const GoldenExample& golden);

/// The largest deviation of `found` from the values of this step in `expected`, relative to
/// max(1, |expected value|). Throws InputError as check_golden_example does.
template <typename Values>
double golden_deviation(const std::string& file, int step, const char* what, const Values& found,
                        const std::vector<float>& expected) {
  double largest = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double wanted = expected[step * found.size() + i];
    const double deviation = std::abs(found[i] - wanted) / std::max(1.0, std::abs(wanted));
    if (!(deviation <= kGoldenTolerance)) {
      fail_file(file, "golden example fails at step {}: {}[{}] is {}, expected {:.9g}", step, what,
                i, found[i], wanted);
    }
    largest = std::max(largest, deviation);
  }
  return largest;
}

}  // namespace sandrunner
