// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <thread>

#include "drivers/imu/imu.h"
#include "rt/core/triple_buffer.h"

namespace sandrunner {

/// An IMU that is read by a thread of its own. A read of a serial line can wait, even one that is
/// told not to: where the kernel's worker has not yet handed on what the line brought, it waits for
/// that worker (n_tty_read, tty_buffer_flush_work), which has ordinary priority. In a control tick
/// that cost up to 6 ms.
class ImuThread {
 public:
  /// Sets the IMU up, which may take seconds, and reads it from then on. InputError as Imu.
  explicit ImuThread(const ImuConfig& config);
  ~ImuThread();
  ImuThread(const ImuThread&) = delete;
  ImuThread& operator=(const ImuThread&) = delete;

  /// Takes the newest sample. True: there is a new one. Wait-free; of one thread.
  bool poll() noexcept;

  const ImuSample& sample() const noexcept { return reading_.sample; }  ///< see Imu
  std::int64_t sample_time_ns() const noexcept { return reading_.sample_time_ns; }
  const Imu::Counters& counters() const noexcept { return reading_.counters; }

  /// Above the policy's, below the control thread's: a sample is old by what it waits.
  static constexpr int kPriority = 75;

 private:
  struct Reading {
    ImuSample sample;
    std::int64_t sample_time_ns = 0;
    Imu::Counters counters;
  };
  void run() noexcept;

  Imu imu_;
  TripleBuffer<Reading> buffer_;
  Reading reading_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace sandrunner
