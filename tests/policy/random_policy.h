// SPDX-License-Identifier: BSD-3-Clause
// A policy with random weights, the same on every machine: for tests that need one that runs, not
// one that walks.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "policy/policy_file.h"
#include "rt/core/split_mix.h"
#include "tests/support/joint_names.h"

namespace sandrunner {

/// Uniform numbers by SplitMix64.
class RandomFloats {
 public:
  explicit RandomFloats(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() { return next_bits(state_); }

  /// In [-1, 1).
  float next() { return static_cast<float>(bits() >> 40) * 0x1p-23f - 1.0f; }

  /// A raw observation; some of its numbers lie beyond the clip of `random_policy_file`.
  std::array<float, kObservationSize> observation() {
    std::array<float, kObservationSize> result;
    for (float& value : result) value = 4.0f * next();
    return result;
  }

 private:
  std::uint64_t state_;
};

/// Weights of a size that keeps the layers' outputs near 1; normalisation about 0 +- 1 with clip 3.
inline PolicyFile random_policy_file(std::uint64_t seed = 1, const Wiring& wiring = {}) {
  PolicyFile file;
  file.parameters.wiring = wiring;
  RandomFloats random(seed);
  for (const NamedTensor& tensor : tensors_of(file.parameters)) {
    const float scale = 2.0f / std::sqrt(static_cast<float>(tensor.shape.back()));
    for (std::size_t i = 0; i < tensor.size(); ++i) tensor.values->push_back(scale * random.next());
  }
  for (float& variance : file.parameters.observation_variance) variance += 1.0f;
  file.parameters.observation_clip = 3.0f;
  PolicySpec& spec = file.spec;
  spec.name = "random";
  std::copy(kJointNames.begin(), kJointNames.end(), spec.joint_names.begin());
  for (int leg = 0; leg < kNumLegs; ++leg) {
    spec.nominal_position_rad[kJointsPerLeg * leg + 1] = 0.5;
    spec.nominal_position_rad[kJointsPerLeg * leg + 2] = -1.0;
  }
  spec.action_scale_rad.fill(0.1);
  spec.kp_nmprad = 40.0;
  spec.kd_nmsprad = 0.75;
  spec.torque_limit_nm = 60.0;
  spec.yaw_command_clip_mps2 = 2.5;
  spec.envelope = {.forward_mps = 4.0,
                   .backward_mps = 4.0,
                   .lateral_mps = 4.0,
                   .yaw_radps = 4.0,
                   .acceleration_mps2 = 100.0,
                   .yaw_acceleration_radps2 = 100.0};
  spec.has_envelope = true;
  for (int i = 0; i < kEstimateSize; ++i) {
    spec.estimate_mean[i] = 0.1f * static_cast<float>(i);
    spec.estimate_variance[i] = 0.25f;
  }
  spec.provenance = {{"seed", std::to_string(seed)}};
  file.golden = make_golden_example(file.parameters);
  return file;
}

}  // namespace sandrunner
