// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "tests/rt/telemetry/dds/support.h"
#include "tests/rt/telemetry/example_tick.h"

namespace sandrunner::ctl {

/// A robot on DDS: it follows velocities and mode requests, and publishes all topics at the rates
/// of a real robot (with the values of example_tick.h, and its own mode).
class FakeRobot {
 public:
  explicit FakeRobot(const DdsConfig& config)
      : setup_(config),
        telemetry_(setup_.participant, config, example_robot(), &setup_.desk, RunClock::kRealtime),
        thread_([this] { publish(); }) {}
  ~FakeRobot() {
    end_ = true;
    thread_.join();
  }

  LiveRobot& robot() { return setup_.robot; }
  Mode mode() const { return setup_.robot.mode(); }
  bool wait_for(Mode wanted) const {
    return wait_until([&] { return mode() == wanted; });
  }

 private:
  void publish() {
    const auto start = std::chrono::steady_clock::now();
    std::uint64_t tick = 0;
    while (!end_) {
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
      for (const std::uint64_t due = ticks_from_s(time.count()); tick < due; ++tick) {
        TickRecord record = example_tick(tick);
        record.output.mode = mode();
        telemetry_.add(record);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

  LiveSetup setup_;
  Telemetry telemetry_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

/// Everything that arrives on rt/cmd_vel, with the time at which it was sent.
class CommandLog {
 public:
  struct Entry {
    std::int64_t sent_ns;  ///< wall clock
    double vx_mps, vy_mps, wz_radps;
    bool is_zero() const { return vx_mps == 0.0 && vy_mps == 0.0 && wz_radps == 0.0; }
  };

  explicit CommandLog(Peer& peer)
      : reader_(peer.reader("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc)) {}

  const std::vector<Entry>& entries() {
    take(reader_, [&](const void* message, const dds_sample_info_t& info) {
      const auto& t = *static_cast<const geometry_msgs_msg_dds__Twist_*>(message);
      entries_.push_back({info.source_timestamp, t.linear.x, t.linear.y, t.angular.z});
    });
    return entries_;
  }

 private:
  dds_entity_t reader_;
  std::vector<Entry> entries_;
};

}  // namespace sandrunner::ctl
