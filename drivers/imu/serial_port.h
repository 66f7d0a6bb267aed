// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace sandrunner {

/// A serial line that this process has for itself: raw bytes, 8N1, no flow control, any speed.
/// Latency is kept low where the driver offers that (ASYNC_LOW_LATENCY: an FTDI converter then
/// passes on what it has after 1 ms instead of 16).
class SerialPort {
 public:
  /// Opens `device` and throws away what it has received. InputError, one line: absent, no serial
  /// line, no right to it, in use, speed not supported.
  SerialPort(const std::string& device, unsigned baud);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// Changes the speed once all is sent, and throws away what has been received: it may have been
  /// read at the wrong one. InputError as above.
  void set_baud(unsigned baud);

  /// What is there, without waiting: the number of bytes, 0 if there is nothing now, -1 if the line
  /// is gone (unplugged).
  int read(std::span<std::uint8_t> into) noexcept;

  /// Waits until there is something to read, or the line is gone, for at most `timeout_ms`. Not for
  /// a real-time thread.
  void wait_readable(int timeout_ms) const noexcept;

  /// Sends all of it, waiting where the line is full. InputError if it takes nothing for 0.5 s or
  /// is gone. Not for a real-time thread.
  void write(std::span<const std::uint8_t> bytes);

  const std::string& device() const noexcept { return device_; }

 private:
  std::string device_;
  int fd_ = -1;
};

}  // namespace sandrunner
