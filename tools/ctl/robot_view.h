// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/sandrunner.h"

namespace sandrunner::ctl {

/// How often something arrived recently.
class RateMeter {
 public:
  void add(std::int64_t now_ns, std::uint64_t amount = 1);
  /// Per second, over the last 3 s; -1: too few arrived.
  double hz(std::int64_t now_ns) const;

 private:
  std::deque<std::pair<std::int64_t, std::uint64_t>> came_;
};

/// What an operator sees of a robot: its messages, summarised as text. All `now_ns` are from the
/// same steady clock.
class RobotView {
 public:
  /// The topics whose rates are shown.
  enum Rate : std::size_t { kJointStates, kImu, kOdometry, kTf, kDiagnostics, kTicks };
  static constexpr std::size_t kNumRates = 6;

  void add(const sandrunner_TickBatch& batch, std::int64_t now_ns);
  void add(const nav_msgs_msg_dds__Odometry_& odometry, std::int64_t now_ns);
  void add(const diagnostic_msgs_msg_dds__DiagnosticArray_& array, std::int64_t now_ns);
  /// A message on a topic of which only the rate is shown.
  void count(Rate topic, std::int64_t now_ns);

  /// Whether anything arrived within the last second.
  bool alive(std::int64_t now_ns) const;
  /// Several lines, without control characters except line ends; "no robot" if it is not alive.
  std::string screen(std::int64_t now_ns) const;
  /// "walk", "damping", ...; "-" if the robot has not told it.
  std::string mode(std::int64_t now_ns) const;
  /// Mode, faults and command in one line; "no robot" if it is not alive.
  std::string line(std::int64_t now_ns) const;

 private:
  std::string value(const std::string& key) const;  // from the diagnostics; "-": none
  bool has_tick(std::int64_t now_ns) const;         // one that is not older than a second
  std::string faults(std::int64_t now_ns) const;
  std::string command(std::int64_t now_ns) const;
  std::string recent(std::size_t part) const;  // quantiles of late, control or write

  std::string robot_ = "-", message_ = "-";  // which one it is, and how it is, by the diagnostics
  sandrunner_TickState tick_{};              // latest
  std::int64_t last_tick_ns_ = 0;
  std::uint64_t sequence_number_ = 0;  // latest; 0: none yet
  std::uint64_t messages_ = 0, lost_messages_ = 0, skipped_ = 0;
  // late, control and write of the last ticks, ns.
  std::vector<std::array<std::uint32_t, 3>> times_;
  std::size_t next_time_ = 0;
  bool has_odometry_ = false;
  std::array<double, 4> speed_{};  // vx, vy m/s, yaw rate rad/s, height m
  std::map<std::string, std::string> diagnostics_;
  std::array<RateMeter, kNumRates> rates_;
  bool came_ = false;
  std::int64_t last_ns_ = 0;
};

}  // namespace sandrunner::ctl
