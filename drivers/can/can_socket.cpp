// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/can/can_socket.h"

#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

CanStatus status_of(int error) noexcept {
  switch (error) {
    case ENOBUFS:
    case EAGAIN:
      return CanStatus::kBusDown;
    case ENETDOWN:
    case ENXIO:
    case ENODEV:
      return CanStatus::kInterfaceDown;
    default:
      return CanStatus::kError;
  }
}

canfd_frame to_kernel(const CanFrame& frame) noexcept {
  canfd_frame result{};
  result.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0);
  result.len = frame.length;
  result.flags = frame.brs ? CANFD_BRS : 0;
  std::copy_n(frame.data.begin(), frame.length, result.data);
  return result;
}

// `bytes`: what the kernel delivered, which tells classic from CAN FD. False: no frame.
bool from_kernel(const canfd_frame& raw, std::size_t bytes, CanFrame& frame) noexcept {
  if (bytes != CAN_MTU && bytes != CANFD_MTU) return false;
  frame = {};
  frame.fd = bytes == CANFD_MTU;
  frame.brs = frame.fd && (raw.flags & CANFD_BRS) != 0;
  frame.error = (raw.can_id & CAN_ERR_FLAG) != 0;
  frame.extended = !frame.error && (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.error || frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.length = std::min<std::uint8_t>(raw.len, frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  // A request to send (RTR) has a length but no data; nobody here asks that way.
  if ((raw.can_id & CAN_RTR_FLAG) != 0 && !frame.error) frame.length = 0;
  std::copy_n(raw.data, frame.length, frame.data.begin());
  return true;
}

// The frames of one system call, as the kernel takes and gives them.
struct Batch {
  std::array<canfd_frame, CanSocket::kMaxFrames> frames;
  std::array<iovec, CanSocket::kMaxFrames> parts;
  std::array<mmsghdr, CanSocket::kMaxFrames> messages{};

  void point(unsigned i, std::size_t bytes) noexcept {
    parts[i] = {&frames[i], bytes};
    messages[i].msg_hdr.msg_iov = &parts[i];
    messages[i].msg_hdr.msg_iovlen = 1;
  }
};
unsigned size_of_batch(std::size_t frames) noexcept {
  return static_cast<unsigned>(std::min<std::size_t>(frames, CanSocket::kMaxFrames));
}

// What an open socket throws if an option is refused.
void set_option(int socket, int level, int name, const void* value, std::size_t size,
                const std::string& interface, const char* what) {
  if (setsockopt(socket, level, name, value, static_cast<socklen_t>(size)) == 0) return;
  throw InputError(fmt::format("CAN interface {}: {}: {}", interface, what, strerror(errno)));
}

void set_flag(int socket, int level, int name, int value, const std::string& interface,
              const char* what) {
  set_option(socket, level, name, &value, sizeof value, interface, what);
}

int index_of(int socket, const CanSocketConfig& config) {
  const std::string& name = config.interface;
  ifreq request{};
  const auto ask = [&](unsigned long what) {
    return name.size() < sizeof request.ifr_name && ioctl(socket, what, &request) == 0;
  };
  name.copy(request.ifr_name, sizeof request.ifr_name - 1);
  if (name.empty() || !ask(SIOCGIFHWADDR)) {
    throw InputError(fmt::format("CAN interface {}: there is no such interface", name));
  }
  if (request.ifr_hwaddr.sa_family != ARPHRD_CAN) {
    throw InputError(fmt::format("CAN interface {}: it is not a CAN interface", name));
  }
  if (config.fd && (!ask(SIOCGIFMTU) || request.ifr_mtu < static_cast<int>(CANFD_MTU))) {
    throw InputError(
        fmt::format("CAN interface {}: it is set up for classic CAN, CAN FD is needed (ip link set "
                    "{} ... fd on)",
                    name, name));
  }
  if (!ask(SIOCGIFINDEX)) {
    throw InputError(fmt::format("CAN interface {}: {}", name, strerror(errno)));
  }
  return request.ifr_ifindex;
}

void set_up(int socket, const CanSocketConfig& config) {
  const std::string& name = config.interface;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index_of(socket, config);

  std::vector<can_filter> filters;
  for (const CanFilter& filter : config.filters) {
    // Both flags in the mask: neither the other kind of identifier nor a request to send passes.
    filters.push_back({filter.id | (filter.extended ? CAN_EFF_FLAG : 0),
                       (filter.mask & CAN_EFF_MASK) | CAN_EFF_FLAG | CAN_RTR_FLAG});
  }
  set_option(socket, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
             filters.size() * sizeof(can_filter), name, "filters");
  const can_err_mask_t errors = CAN_ERR_MASK;
  set_option(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors, name, "error frames");
  set_flag(socket, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, config.fd ? 1 : 0, name, "CAN FD");
  set_flag(socket, SOL_CAN_RAW, CAN_RAW_LOOPBACK, config.loopback ? 1 : 0, name, "loopback");
  set_flag(socket, SOL_SOCKET, SO_TIMESTAMPING,
           SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE, name, "time stamps");
  set_flag(socket, SOL_SOCKET, SO_RXQ_OVFL, 1, name, "overflow counter");
  if (config.receive_buffer_bytes > 0 &&
      // Beyond the system's limit with the right to it only; else as much as that allows.
      setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &config.receive_buffer_bytes,
                 sizeof config.receive_buffer_bytes) != 0) {
    set_flag(socket, SOL_SOCKET, SO_RCVBUF, config.receive_buffer_bytes, name, "receive buffer");
  }
  if (bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw InputError(fmt::format("CAN interface {}: {}", name, strerror(errno)));
  }
}

}  // namespace

const char* words(CanStatus status) noexcept {
  switch (status) {
    case CanStatus::kOk:
      return "ok";
    case CanStatus::kBusDown:
      return "the bus takes no frames";
    case CanStatus::kInterfaceDown:
      return "the interface is down";
    case CanStatus::kBadFrame:
      return "a frame that the bus can not carry";
    case CanStatus::kError:
      return "system error";
  }
  return "";
}

CanSocket::CanSocket(const CanSocketConfig& config) : fd_(config.fd) {
  descriptor_ = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (descriptor_ < 0) {
    const bool no_can = errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT;
    throw InputError(
        fmt::format("CAN interface {}: {}", config.interface,
                    no_can ? "this kernel has no CAN (modules can and can-raw)" : strerror(errno)));
  }
  try {
    set_up(descriptor_, config);
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

CanSocket::~CanSocket() { close(descriptor_); }

CanResult CanSocket::send(std::span<const CanFrame> frames) noexcept {
  CanResult result;
  for (const CanFrame& frame : frames) {
    if (!is_sendable(frame) || (frame.fd && !fd_)) {
      result.status = CanStatus::kBadFrame;
      return result;
    }
  }
  while (result.frames < static_cast<int>(frames.size())) {
    Batch batch;
    const auto rest = frames.subspan(result.frames);
    const unsigned count = size_of_batch(rest.size());
    for (unsigned i = 0; i < count; ++i) {
      batch.frames[i] = to_kernel(rest[i]);
      batch.point(i, rest[i].fd ? CANFD_MTU : CAN_MTU);
    }
    const int sent = sendmmsg(descriptor_, batch.messages.data(), count, MSG_DONTWAIT);
    if (sent > 0) {
      // Where a later frame was not taken, the next round says why.
      result.frames += sent;
    } else if (errno != EINTR) {
      result.error = errno;
      result.status = status_of(result.error);
      return result;
    }
  }
  return result;
}

CanResult CanSocket::receive(std::span<ReceivedFrame> frames) noexcept {
  CanResult result;
  while (result.frames < static_cast<int>(frames.size())) {
    constexpr std::size_t kControlBytes =
        CMSG_SPACE(sizeof(scm_timestamping)) + CMSG_SPACE(sizeof(std::uint32_t));
    struct alignas(cmsghdr) Control {
      std::array<char, kControlBytes> bytes;
    };
    Batch batch;
    std::array<Control, kMaxFrames> controls;
    const unsigned count = size_of_batch(frames.size() - result.frames);
    for (unsigned i = 0; i < count; ++i) {
      batch.point(i, CANFD_MTU);
      batch.messages[i].msg_hdr.msg_control = &controls[i];
      batch.messages[i].msg_hdr.msg_controllen = sizeof controls[i];
    }
    const int received = recvmmsg(descriptor_, batch.messages.data(), count, MSG_DONTWAIT, nullptr);
    if (received < 0) {
      if (errno == EINTR) continue;
      if (errno == EAGAIN) return result;
      result.error = errno;
      result.status = status_of(result.error);
      return result;
    }
    for (int i = 0; i < received; ++i) {
      msghdr& header = batch.messages[i].msg_hdr;
      ReceivedFrame& into = frames[result.frames];
      into.stamp_ns = 0;
      for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr;
           part = CMSG_NXTHDR(&header, part)) {
        if (part->cmsg_level != SOL_SOCKET) continue;
        if (part->cmsg_type == SO_TIMESTAMPING) {
          scm_timestamping stamps;
          std::memcpy(&stamps, CMSG_DATA(part), sizeof stamps);
          into.stamp_ns = stamps.ts[0].tv_sec * 1'000'000'000 + stamps.ts[0].tv_nsec;
        } else if (part->cmsg_type == SO_RXQ_OVFL) {
          std::uint32_t total = 0;
          std::memcpy(&total, CMSG_DATA(part), sizeof total);
          overflowed_ += total - last_overflow_;  // modulo 2^32, as the kernel counts
          last_overflow_ = total;
        }
      }
      if (from_kernel(batch.frames[i], batch.messages[i].msg_len, into.frame)) ++result.frames;
    }
    if (received < static_cast<int>(count)) return result;
  }
  return result;
}

}  // namespace sandrunner
