// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/hardware_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

/// Joint speed that the replies of every drive can report, with a margin: a threshold above it
/// would never be passed.
double reportable_speed_radps(const HardwareConfig& h) noexcept {
  double most = std::numeric_limits<double>::infinity();
  for (const DriveConfig& drive : h.drives) most = std::min(most, 0.98 * drive.reply_speed_radps());
  return most;
}

}  // namespace

void fit_gate_to(const HardwareConfig& h, GateConfig& gate) noexcept {
  const auto ticks = static_cast<std::uint64_t>(h.ticks_per_exchange());
  // A value is sent for in one exchange, comes in the ticks up to the next one, and may be lost:
  // two losses in a row are a fault.
  gate.joints_limit_ticks = std::max(gate.joints_limit_ticks, ticks + 2);
  gate.joints_fault_ticks = std::max(gate.joints_fault_ticks, 3 * ticks);
  const auto imu_ticks = static_cast<std::uint64_t>(kControlHz / h.imu.rate_hz);
  gate.imu_limit_ticks = std::max(gate.imu_limit_ticks, imu_ticks + 4);
  gate.imu_late_ticks = std::max(gate.imu_late_ticks, 3 * imu_ticks);
  gate.imu_fault_ticks = std::max(gate.imu_fault_ticks, 4 * imu_ticks);
  gate.imu_attitude_samples =
      static_cast<std::uint64_t>(std::max(1, h.imu.rate_hz / h.imu.quaternion_rate_hz));
  for (double& limit_nm : gate.torque_limit_nm) limit_nm *= h.torque_scale;
  for (double& fault_radps : gate.speed_fault_radps) {
    fault_radps = std::min(fault_radps, reportable_speed_radps(h));
  }
  gate.hanging = h.hanging;
}

void fit_drives_to(const GateConfig& gate, HardwareConfig& h) {
  // Between two commands lie what the loop may miss and the rest of an exchange.
  const double stall_s = kControlPeriod_s * (static_cast<double>(gate.stall_fault_ticks) +
                                             static_cast<double>(h.ticks_per_exchange()));
  if (h.drive_timeout_s <= stall_s) {
    throw InputError(
        fmt::format("hardware.drive_timeout_s: {}, expected more than the {} s that the loop may "
                    "miss and an exchange takes (controller.gate.stall_fault_ticks)",
                    h.drive_timeout_s, stall_s));
  }
  const double reportable_radps = reportable_speed_radps(h);
  const double highest_radps = *std::ranges::max_element(gate.speed_fault_radps);
  if (highest_radps > reportable_radps) {
    throw InputError(
        fmt::format("controller.gate.speed_fault_radps: {} rad/s is more than the drives' replies "
                    "can report, {:.1f}; it would never be a fault",
                    highest_radps, reportable_radps));
  }
  for (int j = 0; j < kNumJoints; ++j) {
    DriveConfig& drive = h.drives[j];
    drive.max_torque_nm = std::min(drive.max_torque_nm, gate.torque_limit_nm[j] / drive.gear);
  }
}

std::vector<std::string> unguarded(const HardwareConfig& config) {
  std::vector<std::string> lines;
  if (config.emergency_stop.chip.empty()) {
    lines.emplace_back("no emergency stop is configured: hardware.emergency_stop.chip is not set");
  }
  const HardwareConfig open;
  if (config.voltage_low_v <= open.voltage_low_v && config.voltage_high_v >= open.voltage_high_v) {
    lines.emplace_back(
        "the supply voltage is not judged: hardware.voltage_low_v and .voltage_high_v are not set");
  }
  return lines;
}

}  // namespace sandrunner
