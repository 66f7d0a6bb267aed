// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/can_link.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace sandrunner::hil {
namespace {

class Socket {
 public:
  Socket(const std::string& interface, int family, int type, int protocol) noexcept
      : descriptor(::socket(family, type | SOCK_CLOEXEC, protocol)) {
    interface.copy(request.ifr_name, sizeof request.ifr_name - 1);
  }
  ~Socket() { close(descriptor); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  int descriptor;
  ifreq request{};
};

}  // namespace

bool set_link(const std::string& interface, bool up) noexcept {
  Socket s(interface, AF_INET, SOCK_DGRAM, 0);
  if (ioctl(s.descriptor, SIOCGIFFLAGS, &s.request) != 0) return false;
  const int flags = up ? s.request.ifr_flags | IFF_UP : s.request.ifr_flags & ~IFF_UP;
  s.request.ifr_flags = static_cast<short>(flags);
  return ioctl(s.descriptor, SIOCSIFFLAGS, &s.request) == 0;
}

bool inject(const std::string& interface, BusEvent event) noexcept {
  Socket s(interface, PF_CAN, SOCK_RAW, CAN_RAW);
  if (ioctl(s.descriptor, SIOCGIFINDEX, &s.request) != 0) return false;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = s.request.ifr_ifindex;
  if (bind(s.descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return false;
  }
  can_frame frame{};
  frame.can_id = CAN_ERR_FLAG | (event == BusEvent::kOff ? CAN_ERR_BUSOFF : CAN_ERR_RESTARTED);
  frame.can_dlc = CAN_ERR_DLC;
  return write(s.descriptor, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame);
}

}  // namespace sandrunner::hil
