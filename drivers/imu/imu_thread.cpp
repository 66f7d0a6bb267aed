// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu_thread.h"

#include <pthread.h>
#include <sched.h>

#include "rt/base/clock_ns.h"

namespace sandrunner {
namespace {

constexpr int kWait_ms = 20;  // until it looks whether it is to end

}  // namespace

ImuThread::ImuThread(const ImuConfig& config) : imu_(config), thread_([this] { run(); }) {}

ImuThread::~ImuThread() {
  end_ = true;
  thread_.join();
}

void ImuThread::run() noexcept {
  // Without the right to it the control thread has none either, and says so.
  const sched_param priority{.sched_priority = kPriority};
  pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
  while (!end_) {
    const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
    imu_.poll(now_ns);
    buffer_.write({imu_.sample(), imu_.sample_time_ns(), imu_.counters()});
    if (imu_.state(now_ns) == Imu::State::kGone) return;
    imu_.wait(kWait_ms);
  }
}

bool ImuThread::poll() noexcept {
  const std::uint64_t samples = reading_.counters.samples;
  reading_ = buffer_.read();
  return reading_.counters.samples != samples;
}

}  // namespace sandrunner
