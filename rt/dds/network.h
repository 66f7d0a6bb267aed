// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sandrunner {

/// Participants that a domain can have on one computer: DDS gives each two UDP ports, from
/// 7410 + 250 * domain on. tools/ros2_localhost.sh and .xml say the same to ROS 2.
inline constexpr int kMostParticipants = 120;

/// Where a participant looks for others.
struct DdsNetwork {
  int domain = 42;               ///< not 0, which every ROS 2 program uses unless told otherwise
  std::string interface = "lo";  ///< network interface; "lo": this computer only
  std::string security_dir;      ///< made by tools/dds_security.sh; empty: no security
  int receive_priority = 0;      ///< SCHED_FIFO of the thread that receives; 0: an ordinary thread
};

/// Configuration of Cyclone DDS. On "lo": unicast within this computer, no multicast. With a
/// `security_dir`: authentication as `identity` (DIR/identity.pem, .key, .perm.p7s), access
/// control, encryption. Throws InputError if one of these files is missing, or if the key is not
/// the certificate's.
std::string cyclone_xml(const DdsNetwork& network, const std::string& identity);

}  // namespace sandrunner
