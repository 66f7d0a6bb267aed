// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/dds_config.h"

#include <fmt/format.h>

#include <filesystem>

#include "rt/base/errors.h"
#include "rt/core/messages.h"
#include "rt/telemetry/dds/security_files.h"

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

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string security_xml(const std::string& dir, const std::string& identity) {
  const std::filesystem::path folder = std::filesystem::absolute(dir);
  const auto file = [&](const std::string& name) {
    const std::filesystem::path path = folder / name;
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(path, unreadable)) {
      throw InputError(fmt::format(
          "DDS security: found no file {}, expected a folder made by tools/dds_security.sh",
          path.string()));
    }
    return "file:" + escaped(path.string());
  };
  std::string xml = fmt::format(
      R"(<Security><Authentication>
  <Library path="dds_security_auth" initFunction="init_authentication" finalizeFunction="finalize_authentication"/>
  <IdentityCA>{}</IdentityCA><IdentityCertificate>{}</IdentityCertificate><PrivateKey>{}</PrivateKey>
 </Authentication><AccessControl>
  <Library path="dds_security_ac" initFunction="init_access_control" finalizeFunction="finalize_access_control"/>
  <PermissionsCA>{}</PermissionsCA><Governance>{}</Governance><Permissions>{}</Permissions>
 </AccessControl><Cryptographic>
  <Library path="dds_security_crypto" initFunction="init_crypto" finalizeFunction="finalize_crypto"/>
 </Cryptographic></Security>)",
      file("ca.pem"), file(identity + ".pem"), file(identity + ".key"), file("ca.pem"),
      file("governance.p7s"), file(identity + ".perm.p7s"));
  check_key(folder / (identity + ".pem"), folder / (identity + ".key"));
  return xml;
}

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

std::string cyclone_xml(const DdsConfig& config, const std::string& identity) {
  const bool loopback = config.interface == "lo";
  // Unicast peers only find a participant that has an index of its own, and tools soon use up the
  // default of ten. Above 119, the ports would be those of the next domain. The second peer is the
  // port on which DDS stacks listen that expect multicast.
  const std::string network =
      loopback
          ? fmt::format(
                R"(<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>
 <AllowMulticast>false</AllowMulticast></General>
 <Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>{}</MaxAutoParticipantIndex>
 <Peers><Peer Address="127.0.0.1"/><Peer Address="127.0.0.1:{}"/></Peers></Discovery>)",
                kMostParticipants - 1, 7400 + 250 * config.domain)
          : fmt::format(
                R"(<General><Interfaces><NetworkInterface name="{}"/></Interfaces></General>)",
                escaped(config.interface));
  // One thread for all sockets: with several, each is woken at the end by a packet to itself, which
  // never arrives if the network interface is gone by then. And at the end each writer waits for
  // the acknowledgements of its readers, even dead ones: not for a second each.
  constexpr const char* kInternal =
      "<Internal><MultipleReceiveThreads>false</MultipleReceiveThreads>"
      "<WriterLingerDuration>100 ms</WriterLingerDuration></Internal>";
  return fmt::format(
      "<CycloneDDS xmlns=\"https://cdds.io/config\"><Domain Id=\"any\">\n {}\n {}\n "
      "{}\n</Domain></CycloneDDS>",
      network, kInternal,
      config.security_dir.empty() ? "" : security_xml(config.security_dir, identity));
}

}  // namespace sandrunner
