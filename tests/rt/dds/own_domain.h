// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "rt/dds/network.h"

namespace sandrunner {

/// A domain that no other test has, drawn from 100 to 200 and reserved by the name of a socket
/// until this process ends, so that tests that run at the same time never meet.
inline int own_domain() {
  std::random_device random;
  int domain = 0;
  for (int tries = 0; tries < 1000; ++tries) {
    domain = 100 + static_cast<int>(random() % 101);
    const std::string name = "sandrunner-test-domain-" + std::to_string(domain);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path + 1, name.size());  // abstract: no file
    const int held = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (bind(held, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) break;
    close(held);
  }
  return domain;
}

inline DdsNetwork own_network() {
  DdsNetwork network;
  network.domain = own_domain();
  return network;
}

/// The ports of a domain's first `count` participants, taken: as if there were that number already.
class TakenPorts {
 public:
  TakenPorts(int domain, int count) {
    for (int port = 7410 + 250 * domain; port < 7410 + 250 * domain + 2 * count; ++port) {
      sockets_.push_back(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(static_cast<std::uint16_t>(port));
      const int bound =
          bind(sockets_.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
      EXPECT_EQ(bound, 0) << port;
    }
  }
  ~TakenPorts() {
    for (const int socket : sockets_) close(socket);
  }
  TakenPorts(const TakenPorts&) = delete;
  TakenPorts& operator=(const TakenPorts&) = delete;

 private:
  std::vector<int> sockets_;
};

}  // namespace sandrunner
