// SPDX-License-Identifier: BSD-3-Clause
#include "rt/dds/network.h"

#include <fmt/format.h>

#include <filesystem>

#include "rt/base/errors.h"
#include "rt/dds/security_files.h"

namespace sandrunner {
namespace {

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

std::string cyclone_xml(const DdsNetwork& network, const std::string& identity) {
  const bool loopback = network.interface == "lo";
  // Unicast peers only find a participant that has an index of its own, and tools soon use up the
  // default of ten. Above 119, the ports would be those of the next domain. The second peer is the
  // port on which DDS stacks listen that expect multicast.
  const std::string where =
      loopback
          ? fmt::format(
                R"(<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>
 <AllowMulticast>false</AllowMulticast></General>
 <Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>{}</MaxAutoParticipantIndex>
 <Peers><Peer Address="127.0.0.1"/><Peer Address="127.0.0.1:{}"/></Peers></Discovery>)",
                kMostParticipants - 1, 7400 + 250 * network.domain)
          : fmt::format(
                R"(<General><Interfaces><NetworkInterface name="{}"/></Interfaces></General>)",
                escaped(network.interface));
  // One thread for all sockets: with several, each is woken at the end by a packet to itself, which
  // never arrives if the network interface is gone by then. And at the end each writer waits for
  // the acknowledgements of its readers, even dead ones: not for a second each. No message that is
  // sent or read here is large; a stranger's may not take this process's memory.
  constexpr const char* kInternal =
      "<Internal><MultipleReceiveThreads>false</MultipleReceiveThreads>"
      "<MaxSampleSize>4 MB</MaxSampleSize>"
      "<WriterLingerDuration>100 ms</WriterLingerDuration></Internal>";
  const std::string priority =
      network.receive_priority == 0
          ? ""
          : fmt::format(
                R"(<Threads><Thread Name="recv"><Scheduling><Class>Realtime</Class><Priority>{}</Priority></Scheduling></Thread></Threads>)",
                network.receive_priority);
  return fmt::format(
      "<CycloneDDS xmlns=\"https://cdds.io/config\"><Domain Id=\"any\">\n {}\n {}\n {}\n "
      "{}\n</Domain></CycloneDDS>",
      where, kInternal, priority,
      network.security_dir.empty() ? "" : security_xml(network.security_dir, identity));
}

}  // namespace sandrunner
