// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rt/base/config_tree.h"
#include "rt/base/settings.h"
#include "rt/dds/network.h"

namespace sandrunner {

/// Table [dds].
struct DdsConfig : DdsNetwork {
  bool enabled = false;
  int ros_hz = 100;              ///< rate of joint states, IMU, odometry and tf
  bool ticks = true;             ///< publish every 4 kHz tick too
  bool stamped_cmd_vel = false;  ///< rt/cmd_vel is a TwistStamped
  double stale_s = 0.3;          ///< a velocity command older than this is ignored

  /// `stale_s` in control ticks. The controller's `operator_hold_ticks` should be the same, so that
  /// the robot slows down instead of stopping dead.
  std::uint64_t stale_ticks() const noexcept;
};

/// Reads the table [dds]. Throws InputError.
DdsConfig read_dds_config(ConfigTree& config);
/// The keys of the table [dds], for the reference.
std::vector<SettingLine> dds_settings();

}  // namespace sandrunner
