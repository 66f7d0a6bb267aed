// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <variant>

#include "drivers/imu/device_clock.h"
#include "drivers/imu/imu_config.h"
#include "drivers/imu/imu_reading.h"
#include "drivers/imu/mip.h"
#include "drivers/imu/serial_port.h"
#include "drivers/imu/xsens.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// The newest sample of an IMU that streams over a serial line, whatever its protocol. The
/// constructor sets the device up and may wait for up to some seconds; `poll` belongs to the thread
/// that reads the line.
///
/// After the line was gone, or the device lost its settings (power), a new object sets it up again.
class Imu {
 public:
  /// Sets the device up (mip_setup.h, xsens_setup.h) and waits for its first sample. InputError,
  /// one line that names the device: what the port, `check` or the IMU refuse, an IMU that does not
  /// answer.
  explicit Imu(const ImuConfig& config);

  /// The state of the stream, as `poll` found it.
  enum class State {
    kStreaming,  ///< new samples come
    kSilent,     ///< nothing comes
    kRepeating,  ///< packets come, but the device's clock stands: one sample again and again
    kGarbage,    ///< bytes come, but no sample: wrong speed, noise, or fields that are missing
    kGone,       ///< the line was hung up: unplugged
  };

  struct Counters {
    std::uint64_t bytes = 0;          ///< read
    std::uint64_t packets = 0;        ///< of sensor data
    std::uint64_t samples = 0;        ///< new ones
    std::uint64_t repeated = 0;       ///< packets whose device time did not advance
    std::uint64_t incomplete = 0;     ///< packets without acceleration, angular rate or time, or
                                      ///< long after the last quaternion
    std::uint64_t wrong_length = 0;   ///< fields with another length than theirs
    std::uint64_t other_packets = 0;  ///< replies, other kinds of data
    std::uint64_t skipped_bytes = 0;  ///< in no packet
    std::uint64_t bad_checksums = 0;
    std::uint64_t clock_restarts = 0;  ///< device's clock went back or jumped
  };

  /// Reads the available bytes and takes the newest sample from them. True: there is a new one.
  /// `now_ns`: CLOCK_MONOTONIC. Never allocates or logs; one system call, which may wait for the
  /// kernel's worker: see ImuThread.
  bool poll(std::int64_t now_ns) noexcept;

  /// Waits until there is something to poll, for at most `timeout_ms`.
  void wait(int timeout_ms) const noexcept { port_.wait_readable(timeout_ms); }

  /// The newest sample; `tick` is 0: the caller computes it from sample_time_ns().
  /// With a quaternion rate below the rate, the orientation is up to that many samples older.
  const ImuSample& sample() const noexcept { return sample_; }
  /// When it was taken, on the clock of `now_ns` (device_clock.h).
  std::int64_t sample_time_ns() const noexcept { return sample_time_ns_; }

  /// Streaming while the last new sample is at most limit_ns() old; else the kind of data since.
  State state(std::int64_t now_ns) const noexcept;
  std::int64_t limit_ns() const noexcept { return limit_ns_; }
  Counters counters() const noexcept;

 private:
  void take(const mip::PacketView& packet, std::int64_t now_ns) noexcept;
  void take(const xsens::MessageView& message, std::int64_t now_ns) noexcept;
  void take(const ImuReading& reading, std::int64_t first_byte_ns, std::int64_t now_ns) noexcept;

  ImuConfig config_;
  SerialPort port_;
  std::variant<mip::Parser, xsens::Parser> parser_;
  xsens::SampleClock xsens_clock_;
  DeviceClock clock_;
  Counters counters_;
  ImuSample sample_;
  std::int64_t sample_time_ns_ = 0;
  std::int64_t limit_ns_ = 0;
  std::int64_t new_ns_ = 0, repeated_ns_ = 0, bytes_ns_ = 0;  // when they last came
  std::uint64_t device_ns_ = 0, quaternion_device_ns_ = 0;
  bool has_quaternion_ = false;
  bool gone_ = false;
};

/// The text of a state.
const char* to_string(Imu::State state) noexcept;

}  // namespace sandrunner
