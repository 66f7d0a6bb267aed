// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rt/run/process_config.h"
#include "sim/simulator.h"
#include "tools/hil/fault_clock.h"
#include "tools/hil/link.h"
#include "tools/hil/scoreboard.h"

namespace sandrunner::hil {

/// What the bench saw.
struct BenchReport {
  double time_s = 0.0;
  Score score;
  LinkFigures link;
  double late_longest_s = 0.0;  ///< of the bench itself: end of a cycle after its slot
};

/// "was_enabled", "walk", "faults", ... A figure that is null has its reason next to it.
std::string report_json(const BenchReport& report);
std::string report_lines(const BenchReport& report);

/// Reads the faults that the bench of this robot is to make. Throws InputError.
std::vector<TimedFault> read_faults(const ProcessConfig& config,
                                    const std::vector<std::string>& texts);

/// Their kinds and what they take, as lines for --help.
std::string fault_kinds_help();

/// The simulated robot at the other end of what connects it with its controller, in real time.
class Bench {
 public:
  /// `imu_device`: this end of the IMU's line (ImuLine), for a robot on CAN buses. `walk_s`: length
  /// of the walk whose speed is measured; 0: all of it. Throws InputError.
  Bench(const ProcessConfig& config, const std::string& imu_device, std::vector<TimedFault> script,
        double walk_s);

  /// Plays as long as `more` returns true, which is called every 10 ms. `controller`: the process
  /// that faults kill or stop; 0: none. `second`: starts a second controller, if given.
  BenchReport play(const std::function<bool()>& more, pid_t controller = 0,
                   const std::function<void()>& second = {});

  std::string greeting() const { return link_->greeting(); }
  bool all_faults_made() const noexcept { return faults_.all_made(); }
  /// Since the last command that the robot follows.
  double silent_s() const noexcept { return link_->silent_s(); }

 private:
  std::unique_ptr<sim::Simulator> robot_;
  std::unique_ptr<Link> link_;
  FaultClock faults_;
  Scoreboard board_;
};

}  // namespace sandrunner::hil
