// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/simulator_beside.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>

#include "rt/realtime/clock.h"
#include "rt/realtime/setup.h"

namespace sandrunner::bench {
namespace {

constexpr std::int64_t kCycle_ns = 2'000'000;
constexpr int kTicksPerCycle = kControlHz / 500;

}  // namespace

SimulatorBeside::SimulatorBeside(const sim::Robot& robot, const sim::SimulatorConfig& config,
                                 int priority)
    : simulator_(robot, config) {
  simulator_.reset_lying();
  Sensed first{.frame = {}, .sampled_ns = monotonic_ns()};
  simulator_.read(0, first.frame);
  sensed_.write(first);
  thread_ = std::thread([this] { simulate(); });
  const sched_param fifo{.sched_priority = priority};
  pthread_setschedparam(thread_.native_handle(), SCHED_FIFO, &fifo);
}

SimulatorBeside::~SimulatorBeside() {
  end_ = true;
  thread_.join();
}

void SimulatorBeside::read(std::uint64_t tick, SensorFrame& frame) noexcept {
  const Sensed& newest = sensed_.read();
  frame.drives_cut = cut_.load(std::memory_order_relaxed) ? 1 : 0;
  if (sensed_.sequence() == seen_) return;
  seen_ = sensed_.sequence();
  const std::int64_t age_ns = std::max<std::int64_t>(monotonic_ns() - newest.sampled_ns, 0);
  const auto sampled =
      tick - std::min(static_cast<std::uint64_t>(age_ns / kControlPeriod_ns), tick);
  frame.joints = newest.frame.joints;
  frame.imu = newest.frame.imu;
  frame.joints.tick.fill(sampled);
  frame.imu.tick = sampled;
}

void SimulatorBeside::simulate() noexcept {
  prepare_this_thread();
  std::uint64_t tick = 0;
  for (std::int64_t due_ns = monotonic_ns(); !end_; due_ns += kCycle_ns) {
    sleep_until(due_ns);
    const SafeCommand command = cut_ ? SafeCommand() : commands_.read();
    for (int i = 0; i < kTicksPerCycle; ++i, ++tick) simulator_.write(command);
    Sensed now{.frame = {}, .sampled_ns = due_ns};
    simulator_.read(tick, now.frame);
    sensed_.write(now);
  }
}

}  // namespace sandrunner::bench
