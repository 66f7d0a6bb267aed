// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rt/base/config_tree.h"
#include "rt/base/settings.h"

namespace sandrunner {

/// Participants that a domain can have on one computer: DDS gives each two UDP ports, from
/// 7410 + 250 * domain on. tools/ros2_localhost.sh and .xml say the same to ROS 2.
inline constexpr int kMostParticipants = 120;

/// Table [dds].
struct DdsConfig {
  bool enabled = false;
  int domain = 42;               ///< not 0, which every ROS 2 program uses unless told otherwise
  std::string interface = "lo";  ///< network interface; "lo": this computer only
  int ros_hz = 100;              ///< rate of joint states, IMU, odometry and tf
  bool ticks = true;             ///< publish every 4 kHz tick too
  bool stamped_cmd_vel = false;  ///< rt/cmd_vel is a TwistStamped
  double stale_s = 0.3;          ///< a velocity command older than this is ignored
  std::string security_dir;      ///< made by tools/dds_security.sh; empty: no security

  /// `stale_s` in control ticks. The controller's `operator_hold_ticks` should be the same, so that
  /// the robot slows down instead of stopping dead.
  std::uint64_t stale_ticks() const noexcept;
};

/// Reads the table [dds]. Throws InputError.
DdsConfig read_dds_config(ConfigTree& config);
/// The keys of the table [dds], for the reference.
std::vector<SettingLine> dds_settings();

/// Configuration of Cyclone DDS. On "lo": unicast within this computer, no multicast. With a
/// `security_dir`: authentication as `identity` (DIR/identity.pem, .key, .perm.p7s), access
/// control, encryption. Throws InputError if one of these files is missing, or if the key is not
/// the certificate's.
std::string cyclone_xml(const DdsConfig& config, const std::string& identity);

}  // namespace sandrunner
