// SPDX-License-Identifier: BSD-3-Clause
#include "policy/policy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sandrunner {

bool has_one_scale(const PolicySpec& spec) {
  return std::ranges::all_of(spec.action_scale_rad,
                             [&](double scale) { return scale == spec.action_scale_rad[0]; });
}

PolicyStep policy_step(const PolicySpec& spec, const std::array<float, kNumJoints>& action,
                       const std::array<float, kEstimateSize>& estimate_raw) noexcept {
  PolicyStep result;
  const double limit =
      spec.action_clip > 0.0 ? spec.action_clip : std::numeric_limits<double>::infinity();
  for (int i = 0; i < kNumJoints; ++i) {
    const double limited = std::clamp(static_cast<double>(action[i]), -limit, limit);
    result.target_rad[i] = spec.nominal_position_rad[i] + spec.action_scale_rad[i] * limited;
  }
  const auto physical = [&](int i) {
    return estimate_raw[i] * std::sqrt(static_cast<double>(spec.estimate_variance[i])) +
           spec.estimate_mean[i];
  };
  result.estimate.body_height_m = physical(0);
  for (int i = 0; i < 3; ++i) result.estimate.velocity_mps[i] = physical(1 + i);
  for (int leg = 0; leg < kNumLegs; ++leg) result.estimate.foot_height_m[leg] = physical(4 + leg);
  return result;
}

}  // namespace sandrunner
