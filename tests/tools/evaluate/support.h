// SPDX-License-Identifier: BSD-3-Clause
// Policies and comparisons for the tests of sandrunner-evaluate.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "policy/policy_file.h"
#include "tests/policy/random_policy.h"
#include "tools/evaluate/metrics.h"

namespace sandrunner::evaluate {

/// Stands stiffly in Raibo's nominal pose and twitches.
inline Policy standing_policy() {
  PolicyFile file = random_policy_file();
  for (int leg = 0; leg < kNumLegs; ++leg) {
    file.spec.nominal_position_rad[kJointsPerLeg * leg + 1] = 0.559836;
    file.spec.nominal_position_rad[kJointsPerLeg * leg + 2] = -1.119672;
  }
  file.spec.action_scale_rad.fill(0.02);
  file.spec.kp_nmprad = 200.0;
  file.spec.kd_nmsprad = 4.0;
  return {file.spec, Network(file.parameters)};
}

/// All figures of a run, bit by bit.
inline std::vector<std::uint64_t> bits_of(const TrialFigures& run) {
  std::vector<std::uint64_t> bits = {std::bit_cast<std::uint64_t>(run.time_s)};
  for (const Metric& m : metrics()) bits.push_back(std::bit_cast<std::uint64_t>(m.of_run(run)));
  return bits;
}

}  // namespace sandrunner::evaluate
