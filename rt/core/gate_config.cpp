// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/gate_config.h"

#include <algorithm>

namespace sandrunner {

GateConfig below_ceilings(const GateConfig& config) noexcept {
  GateConfig c = config;
  const auto lower = [&](auto GateConfig::*threshold) {
    c.*threshold = std::min(c.*threshold, kGateCeilings.*threshold);
  };
  for (const auto threshold :
       {&GateConfig::joint_fault_rad, &GateConfig::target_margin_rad, &GateConfig::target_step_rad,
        &GateConfig::speed_fault_radps, &GateConfig::encoder_jump_rad,
        &GateConfig::torque_fault_ratio, &GateConfig::torque_fault_s, &GateConfig::kp_limit_nmprad,
        &GateConfig::kd_limit_nmsprad, &GateConfig::power_limit_w,
        &GateConfig::continuous_torque_nm, &GateConfig::thermal_time_s, &GateConfig::tilt_limit_deg,
        &GateConfig::tilt_fault_s, &GateConfig::tilt_fault_deg, &GateConfig::free_fall_s,
        &GateConfig::frozen_moved_rad, &GateConfig::frozen_told_rad}) {
    lower(threshold);
  }
  for (const auto threshold : {&GateConfig::joints_limit_ticks, &GateConfig::joints_fault_ticks,
                               &GateConfig::imu_limit_ticks, &GateConfig::imu_fault_ticks,
                               &GateConfig::policy_fault_ticks, &GateConfig::stall_fault_ticks,
                               &GateConfig::frozen_ticks, &GateConfig::policy_frozen_steps}) {
    lower(threshold);
  }
  return c;
}

}  // namespace sandrunner
