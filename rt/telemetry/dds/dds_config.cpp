// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/dds_config.h"

#include <fmt/format.h>

#include "rt/base/errors.h"
#include "rt/core/messages.h"

namespace sandrunner {
namespace {

constexpr const char* kVelocityTypes[] = {"twist", "twist_stamped"};

using C = DdsConfig;
constexpr Setting<C> kDds[] = {
    {"enabled", &C::enabled, "Publish telemetry over DDS; --command dds sets it."},
    {"domain", &C::domain, 0, 230, "DDS domain (ROS_DOMAIN_ID)."},
    {"interface", &C::interface, "Network interface; lo: this computer only."},
    {"ros_hz", &C::ros_hz, 1, 200, "Rate of joint states, IMU, odometry and tf."},
    {"ticks", &C::ticks, "Publish every control tick on sandrunner/ticks."},
    {"cmd_vel", words<&C::stamped_cmd_vel>(kVelocityTypes), "Message type of rt/cmd_vel."},
    {"stale_s", &C::stale_s, 0.01, 10.0,
     "An operator's velocity older than this is ignored; the robot slows down."},
    {"security_dir", &C::security_dir,
     "Folder with keys and certificates (--dds-security); empty: no security."},
};

}  // namespace

std::uint64_t DdsConfig::stale_ticks() const noexcept { return ticks_from_s(stale_s); }

DdsConfig read_dds_config(ConfigTree& config) {
  DdsConfig c;
  read_settings(config, "dds", kDds, c);
  if (c.interface.empty()) {
    throw InputError(
        "dds.interface: found an empty name, expected a network interface (\"lo\": this "
        "computer only)");
  }
  return c;
}

std::vector<SettingLine> dds_settings() {
  std::vector<SettingLine> lines;
  list_settings(lines, "dds", kDds);
  return lines;
}

}  // namespace sandrunner
