// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

namespace sandrunner {

/// Tells from an IMU's own clock when, on the host's clock, a sample was taken.
///
/// host - device, taken at a packet's first byte, is the clocks' true offset plus a latency that is
/// never negative: scheduling, a converter's buffer, the period of the poll. The least latency is
/// therefore the best evidence there is, and a mean would follow every late read. So the offset is
/// the lower envelope: a smaller one counts at once, a greater one never does; meanwhile it rises
/// by the most that the clocks can drift apart. Two numbers of memory, no window, no matrix, and a
/// late read of any length moves the estimate by its length times that drift.
///
/// What is constant in the latency (the device's own filter, one byte on the wire) cannot be seen
/// from here: sample times are late by it. Else they are late by what remains of the jitter: with
/// 500 packets a second that are read up to 0.25 ms late by chance, 0.08 ms at most and 0.02 ms on
/// average (device_clock_test.cpp); never later than the packet's first byte, and never backwards.
class DeviceClock {
 public:
  /// A packet's first byte was seen at `host_ns`; its sample was taken at `device_ns`. Gives the
  /// time of the sample on the host's clock.
  std::int64_t update(std::uint64_t device_ns, std::int64_t host_ns) noexcept {
    const std::uint64_t measured = static_cast<std::uint64_t>(host_ns) - device_ns;
    if (started_ && device_ns >= device_ns_) {
      const std::uint64_t expected = offset_ + (device_ns - device_ns_) / kDriftDivisor;
      // Unsigned arithmetic wraps, so that no value of a broken device is undefined behaviour.
      const auto late_ns = static_cast<std::int64_t>(measured - expected);
      if (late_ns < kLost_ns || late_since_ns_ == kNotLate) {
        late_since_ns_ = late_ns < kLost_ns ? kNotLate : host_ns;
      }
      const bool lost = late_since_ns_ != kNotLate && host_ns - late_since_ns_ > kLostFor_ns;
      if (lost || late_ns < -kLost_ns) {
        restart(measured);
      } else {
        offset_ = late_ns < 0 ? measured : expected;
      }
    } else {
      restart(measured);
    }
    device_ns_ = device_ns;
    const auto sample_ns = static_cast<std::int64_t>(offset_ + device_ns);
    newest_ns_ = std::clamp(sample_ns, std::min(newest_ns_, host_ns), host_ns);
    return newest_ns_;
  }

  /// How often the fit began anew, after its first beginning: the device's clock went back or
  /// jumped ahead, or the host's did.
  std::uint64_t restarts() const noexcept { return restarts_; }

 private:
  /// Most that the clocks drift apart: 50 ppm for each quartz, and the 500 ppm by which the kernel
  /// may slew CLOCK_MONOTONIC (adjtimex(2)). 1 / 600 ppm.
  static constexpr std::uint64_t kDriftDivisor = 1'000'000 / 600;
  /// No latency explains a sample that comes this early, and none lasts this long: a clock jumped.
  /// Longer than any buffer holds back (16 ms in USB converters) and any backlog takes to drain.
  static constexpr std::int64_t kLost_ns = 50'000'000, kLostFor_ns = 1'000'000'000;
  static constexpr std::int64_t kNotLate = INT64_MIN;

  void restart(std::uint64_t measured) noexcept {
    restarts_ += started_ ? 1 : 0;
    started_ = true;
    offset_ = measured;
    late_since_ns_ = kNotLate;
  }

  std::uint64_t offset_ = 0;     // host - device, modulo 2^64
  std::uint64_t device_ns_ = 0;  // of the last packet
  std::int64_t late_since_ns_ = kNotLate;
  std::int64_t newest_ns_ = INT64_MIN;
  std::uint64_t restarts_ = 0;
  bool started_ = false;
};

}  // namespace sandrunner
