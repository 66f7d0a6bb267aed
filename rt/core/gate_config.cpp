// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/gate_config.h"

#include <algorithm>

namespace sandrunner {

GateConfig below_ceilings(const GateConfig& config) noexcept {
  GateConfig c = config;
  const auto lower = [&](const auto& threshold) {
    c.*threshold.value = std::min(c.*threshold.value, threshold.ceiling);
  };
  for (const auto& threshold : kGateThresholds) lower(threshold);
  for (const auto& threshold : kGateTickThresholds) lower(threshold);
  for (const auto& threshold : kGateJointThresholds) {
    for (double& value : c.*threshold.value) value = std::min(value, threshold.ceiling);
  }
  return c;
}

}  // namespace sandrunner
