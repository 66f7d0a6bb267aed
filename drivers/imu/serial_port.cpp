// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/serial_port.h"

// The kernel's own termios, which alone takes any speed (BOTHER); glibc's <termios.h> names the
// same things and can't be included beside it.
#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "rt/base/errors.h"

namespace sandrunner {

namespace {

[[noreturn]] void refuse(const std::string& device, const std::string& why) {
  throw InputError(one_line(fmt::format("serial line {}: {}", device, why)));
}

std::string open_error(int error) {
  switch (error) {
    case ENOENT:
      return "does not exist; is the device plugged in?";
    case ENODEV:
    case ENXIO:
      return "there is no device behind it";
    case EACCES:
    case EPERM:
      return "no right to read and write it; serial lines belong to the group dialout";
    case EBUSY:
      return "in use by another program";
    default:
      return fmt::format("can't be opened: {}", std::strerror(error));
  }
}

/// Owns the descriptor until the port is complete.
class OpenFile {
 public:
  explicit OpenFile(int fd) : fd_(fd) {}
  ~OpenFile() {
    if (fd_ >= 0) ::close(fd_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

void set_line(int fd, const std::string& device, unsigned baud) {
  termios2 line{};
  if (ioctl(fd, TCGETS2, &line) != 0) refuse(device, "is not a serial line");
  line.c_iflag = IGNBRK;
  line.c_oflag = 0;
  line.c_lflag = 0;
  line.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
  line.c_ispeed = line.c_ospeed = baud;
  // With VMIN 1 an empty line answers EAGAIN: 0 bytes then mean that it is gone.
  line.c_cc[VMIN] = 1;
  line.c_cc[VTIME] = 0;
  // TCSETSW2: after what was written has been sent. A driver rounds to what it can do, and says so.
  if (ioctl(fd, TCSETSW2, &line) != 0 || ioctl(fd, TCGETS2, &line) != 0) {
    refuse(device, fmt::format("does not take {} baud: {}", baud, std::strerror(errno)));
  }
  constexpr double kMostOff = 0.02;  // a receiver samples the tenth bit half a bit off at 5 %
  if (std::abs(static_cast<double>(line.c_ospeed) - baud) > kMostOff * baud) {
    refuse(device, fmt::format("does not take {} baud, only {}", baud, line.c_ospeed));
  }
  ioctl(fd, TCFLSH, TCIFLUSH);
}

}  // namespace

SerialPort::SerialPort(const std::string& device, unsigned baud) : device_(device) {
  // O_NONBLOCK also keeps open() from waiting for a carrier.
  const int fd = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) refuse(device, open_error(errno));
  OpenFile file(fd);
  termios2 line{};
  if (ioctl(fd, TCGETS2, &line) != 0) refuse(device, "is not a serial line");
  // TIOCEXCL keeps others out, but not root; the lock keeps out root's second controller.
  if (flock(fd, LOCK_EX | LOCK_NB) != 0 || ioctl(fd, TIOCEXCL) != 0) {
    refuse(device, open_error(errno == EWOULDBLOCK ? EBUSY : errno));
  }
  set_line(fd, device, baud);
  serial_struct serial{};
  if (ioctl(fd, TIOCGSERIAL, &serial) == 0) {  // a pseudo-terminal, for one, has none
    serial.flags |= ASYNC_LOW_LATENCY;
    ioctl(fd, TIOCSSERIAL, &serial);
  }
  fd_ = file.release();
}

SerialPort::~SerialPort() {
  // The terminal lives on where another program has it open, which may then open it again.
  ioctl(fd_, TIOCNXCL);
  ::close(fd_);
}

void SerialPort::set_baud(unsigned baud) { set_line(fd_, device_, baud); }

int SerialPort::read(std::span<std::uint8_t> into) noexcept {
  const ssize_t count = ::read(fd_, into.data(), into.size());
  if (count > 0) return static_cast<int>(count);
  return count < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

void SerialPort::wait_readable(int timeout_ms) const noexcept {
  pollfd wanted{.fd = fd_, .events = POLLIN, .revents = 0};
  ::poll(&wanted, 1, timeout_ms);
}

void SerialPort::write(std::span<const std::uint8_t> bytes) {
  constexpr int kTimeout_ms = 500;
  while (!bytes.empty()) {
    const ssize_t count = ::write(fd_, bytes.data(), bytes.size());
    if (count > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    } else if (count < 0 && errno != EAGAIN && errno != EINTR) {
      refuse(device_, fmt::format("can't be written: {}", std::strerror(errno)));
    } else {
      pollfd wanted{.fd = fd_, .events = POLLOUT, .revents = 0};
      if (::poll(&wanted, 1, kTimeout_ms) == 0) refuse(device_, "takes nothing to send");
    }
  }
}

}  // namespace sandrunner
