// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/unitree_config.h"

#include <algorithm>
#include <iterator>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

using C = UnitreeConfig;
/// Robots on CAN buses have these too, and list them.
constexpr Setting<C> kShared[] = {
    {"temperature_limit_degc", &C::temperature_limit_degc, 0.0, 150.0, ""},
    {"torque_scale", &C::torque_scale, 0.0, 1.0, ""},
    {"hanging", &C::hanging, ""},
};
constexpr Setting<C> kUnitree[] = {
    {"interface", &C::interface, "Network interface to the robot; lo: an emulated one.", kRequired},
    {"domain", &C::domain, 0, 230, "DDS domain of the robot."},
    {"motor_mode", &C::motor_mode, 1, 255, "Mode of a motor that gives torque; a B2's is 10."},
    {"tick_hz", &C::tick_hz, 1, 1e6, "Rate of the clock in its states."},
    {"low_battery_percent", &C::low_battery_percent, 0, 100,
     "Warning: the battery has less. Fault: less than half of it."},
    {"need_remote", &C::need_remote,
     "A remote control that is off or lost is an emergency stop, as its L2 with B always is."},
    {"release_sport_mode", &C::release_sport_mode,
     "Switch the robot's own controller off at the start; false: it is off already."},
};

// A state comes every 8 ticks.
constexpr std::uint64_t kStateLate_ticks = 12, kStateLost_ticks = 40;

}  // namespace

UnitreeConfig read_unitree_config(ConfigTree& config) {
  UnitreeConfig c;
  read_settings(config, "hardware", kShared, c);
  read_settings(config, "hardware.unitree", kUnitree, c);
  if (c.interface.empty()) {
    throw InputError(
        "hardware.unitree.interface: found none, expected the network interface to the robot "
        "(`ip addr` lists them; \"lo\" for an emulated robot)");
  }
  return c;
}

std::vector<SettingLine> unitree_settings() {
  std::vector<SettingLine> lines;
  list_settings(lines, "hardware.unitree", kUnitree);
  return lines;
}

void fit_gate_to(const UnitreeConfig& unitree, GateConfig& gate) noexcept {
  gate.joints_limit_ticks = std::max(gate.joints_limit_ticks, kStateLate_ticks);
  gate.joints_fault_ticks = std::max(gate.joints_fault_ticks, kStateLost_ticks);
  gate.imu_limit_ticks = std::max(gate.imu_limit_ticks, kStateLate_ticks);
  for (double& limit_nm : gate.torque_limit_nm) limit_nm *= unitree.torque_scale;
  gate.hanging = unitree.hanging;
}

}  // namespace sandrunner
