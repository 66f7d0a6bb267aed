// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "rt/base/clock_ns.h"
#include "rt/core/messages.h"
#include "sim/simulator.h"
#include "tools/hil/fault_script.h"
#include "tools/hil/scoreboard.h"

namespace sandrunner::hil {

/// What a link adds to the report of the bench.
struct LinkFigures {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  std::string lines;  ///< for a person
  std::string bench;  ///< part of the line about the bench itself
  std::string wrong;  ///< with the controller, whatever the run; empty: nothing
};

/// The robot's end of what connects it with its controller: drives, sensors and their messages. One
/// thread, in real time on CLOCK_MONOTONIC.
class Link {
 public:
  virtual ~Link() = default;

  /// That the robot is there, for a person who may start the controller then.
  virtual std::string greeting() const = 0;
  virtual std::int64_t cycle_ns() const noexcept = 0;

  void begin(std::int64_t start_ns) noexcept { start_ns_ = start_ns; }
  /// Talks with the controller until the cycle ends. Returns the time of the rest of the cycle, s
  /// since the start.
  virtual double exchange(std::int64_t end_ns) = 0;
  /// False: it is none of this link.
  virtual bool make(const TimedFault& fault, double now_s) = 0;
  /// Moves the robot on by a cycle, under its drives' torques. Returns what these do.
  virtual const JointArray<DriveMoment>& step(double now_s, sim::Simulator& robot) = 0;

  virtual LinkFigures figures(bool was_enabled) const = 0;
  /// Since the start.
  double now_s() const noexcept {
    return 1e-9 * static_cast<double>(clock_ns(CLOCK_MONOTONIC) - start_ns_);
  }
  /// Since the last command that the robot follows.
  double silent_s() const noexcept { return now_s() - commanded_s_; }

 protected:
  std::int64_t start_ns_ = 0;
  double commanded_s_ = 0.0;
  double fault_s_ = 0.0;  ///< when the fault is made
};

}  // namespace sandrunner::hil
