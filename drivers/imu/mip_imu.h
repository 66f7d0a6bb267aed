// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "drivers/imu/device_clock.h"
#include "drivers/imu/imu_mounting.h"
#include "drivers/imu/mip.h"
#include "drivers/imu/serial_port.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// A MicroStrain IMU that knows the commands of the 3DM-CV7 and later (a GX5's manual has others).
struct MipImuConfig {
  std::string device;            ///< better its name in /dev/serial/by-id than /dev/ttyUSB0
  unsigned baud = 921600;        ///< of kMipBauds; the device is told to use it
  int rate_hz = 500;             ///< acceleration, angular rate, device time
  int quaternion_rate_hz = 500;  ///< attitude: `rate_hz`, or that over a whole number
  ImuMounting mounting;
};

/// Speeds that the driver looks for a device at: those of the 3DM-CV7 (user manual, "Protocol
/// Support"; 3,000,000 with GNSS only), the two usual ones first.
inline constexpr std::array<unsigned, 5> kMipBauds = {115200, 921600, 460800, 230400, 3000000};

/// What of the line the stream takes: 10 bits a byte.
double mip_line_load(int rate_hz, int quaternion_rate_hz, unsigned baud) noexcept;
/// InputError, one line, if the configuration can't work with any device: rates, speed, or a stream
/// that takes more than 80 % of the line. Needs no device.
void check(const MipImuConfig& config);

/// The newest sample of an IMU that streams over a serial line. The constructor sets the device up
/// and may wait for up to some seconds; `poll` belongs to the thread that reads the line.
///
/// After the line was gone, or the device lost its settings (power), a new object sets it up again.
class MipImu {
 public:
  /// Finds the device's speed, sets idle, asks the base rate, sets speed and message format, turns
  /// the stream on, and waits for its first sample; each step is acknowledged. InputError, one line
  /// that names the device: what the port, `check` or the IMU refuse, an IMU that does not answer,
  /// rates that its base rate is no multiple of.
  explicit MipImu(const MipImuConfig& config);

  /// What the stream is like, as far as `poll` saw it.
  enum class State {
    kStreaming,  ///< new samples come
    kSilent,     ///< nothing comes
    kRepeating,  ///< packets come, but the device's clock stands: one sample again and again
    kGarbage,    ///< bytes come, but no sample: wrong speed, noise, or fields that are missing
    kGone,       ///< the line was hung up: unplugged
  };

  struct Counters {
    std::uint64_t bytes = 0;         ///< read
    std::uint64_t packets = 0;       ///< of sensor data
    std::uint64_t samples = 0;       ///< new ones
    std::uint64_t repeated = 0;      ///< packets whose device time did not advance
    std::uint64_t incomplete = 0;    ///< packets without acceleration, angular rate or time, or
                                     ///< long after the last quaternion
    std::uint64_t wrong_length = 0;  ///< fields with another length than theirs
    std::uint8_t wrong_length_field = 0;  ///< descriptor of the last: mip::sensor_field_name
    std::uint64_t other_packets = 0;      ///< replies, other descriptor sets
    std::uint64_t skipped_bytes = 0;      ///< in no packet
    std::uint64_t bad_checksums = 0;
    std::uint64_t clock_restarts = 0;  ///< device's clock went back or jumped
  };

  /// Reads what is there and takes the newest sample from it. True: there is a new one. `now_ns`:
  /// CLOCK_MONOTONIC. Never allocates or logs; one system call, which may wait for the kernel's
  /// worker: see ImuThread.
  bool poll(std::int64_t now_ns) noexcept;

  /// Waits until there is something to poll, for at most `timeout_ms`.
  void wait(int timeout_ms) const noexcept { port_.wait_readable(timeout_ms); }

  /// The newest sample; `tick` is 0: who knows the loop's ticks makes it from sample_time_ns().
  /// With a quaternion rate below the rate, the orientation is up to that many samples older.
  const ImuSample& sample() const noexcept { return sample_; }
  /// When it was taken, on the clock of `now_ns` (device_clock.h).
  std::int64_t sample_time_ns() const noexcept { return sample_time_ns_; }

  /// Streaming as long as the last new sample came at most limit_ns() ago; then, what came since.
  State state(std::int64_t now_ns) const noexcept;
  std::int64_t limit_ns() const noexcept { return limit_ns_; }
  Counters counters() const noexcept;

 private:
  void set_up();
  /// Sends the command and waits for its answer. False: none came within the time.
  bool ask(const mip::Packet& command, int timeout_ms, mip::Reply& reply,
           std::span<std::uint8_t> response = {});
  /// The same, three times if need be; InputError where there is no answer, or a refusal. `what`:
  /// what the command was to do, for the message.
  void demand(const mip::Packet& command, const char* what, std::span<std::uint8_t> response = {});
  /// The speed at which the device answers.
  unsigned find_speed();
  void change_speed(unsigned found_baud);
  void take(const mip::PacketView& packet, std::int64_t now_ns) noexcept;
  [[noreturn]] void refuse(const std::string& why) const;

  MipImuConfig config_;
  SerialPort port_;
  mip::Parser parser_;
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

/// What to print of a state.
const char* to_string(MipImu::State state) noexcept;

}  // namespace sandrunner
