// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/can_interface.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/pkt_sched.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>

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

// vcan has no queue, so that none is ever full: it is given a pfifo. RTM_NEWQDISC or RTM_DELQDISC.
bool change_queue(const std::string& interface, std::uint16_t what, std::uint16_t flags,
                  unsigned frames) noexcept {
  const Socket s(interface, AF_NETLINK, SOCK_RAW, NETLINK_ROUTE);
  struct {
    nlmsghdr head{};
    tcmsg queue{};
    rtattr kind{.rta_len = RTA_LENGTH(sizeof kind_name), .rta_type = TCA_KIND};
    char kind_name[8] = "pfifo";
    rtattr options{.rta_len = RTA_LENGTH(sizeof limit), .rta_type = TCA_OPTIONS};
    tc_fifo_qopt limit{};
  } request;
  request.head.nlmsg_len = sizeof request;
  request.head.nlmsg_type = what;
  request.head.nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK | flags;
  request.queue.tcm_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  request.queue.tcm_parent = TC_H_ROOT;
  request.queue.tcm_handle = 1u << 16;
  request.limit.limit = frames;
  struct {
    nlmsghdr head;
    nlmsgerr result;
    char rest[256];
  } answer;
  return send(s.descriptor, &request, sizeof request, 0) == static_cast<ssize_t>(sizeof request) &&
         recv(s.descriptor, &answer, sizeof answer, 0) >=
             static_cast<ssize_t>(sizeof answer.head) &&
         answer.head.nlmsg_type == NLMSG_ERROR && answer.result.error == 0;
}

}  // namespace

bool set_link(const std::string& interface, bool up) noexcept {
  Socket s(interface, AF_INET, SOCK_DGRAM, 0);
  if (ioctl(s.descriptor, SIOCGIFFLAGS, &s.request) != 0) return false;
  const int flags = up ? s.request.ifr_flags | IFF_UP : s.request.ifr_flags & ~IFF_UP;
  s.request.ifr_flags = static_cast<short>(flags);
  return ioctl(s.descriptor, SIOCSIFFLAGS, &s.request) == 0;
}

bool set_queue(const std::string& interface, unsigned frames) noexcept {
  return change_queue(interface, RTM_NEWQDISC, NLM_F_CREATE | NLM_F_REPLACE, frames);
}

bool remove_queue(const std::string& interface) noexcept {
  return change_queue(interface, RTM_DELQDISC, 0, 0);
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
