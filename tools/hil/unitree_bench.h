// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rt/run/process_config.h"
#include "tools/hil/bench_report.h"
#include "tools/hil/emulated/unitree_peer.h"
#include "tools/hil/emulated_robot.h"
#include "tools/hil/unitree_script.h"

namespace sandrunner::hil {

/// What the bench saw of a controller of a Unitree robot.
struct UnitreeReport {
  double time_s = 0.0;
  bool was_enabled = false;   ///< all motors were commanded together at a time
  bool off_at_end = true;     ///< no motor was, with the last command
  bool base_touched = false;  ///< the ground, while it walked
  double distance_m = 0.0;    ///< from where it lay, level
  double walked_s = 0.0;
  std::optional<double> mean_speed_mps;  ///< over the second half of the walk
  std::uint64_t states = 0, commands = 0;
  std::uint64_t refused = 0;                          ///< commands that a robot may not follow ...
  std::string refusal;                                ///< ... and what was wrong with the first
  int writers = 0;                                    ///< of commands
  double command_rate_hz = 0.0, longest_gap_s = 0.0;  ///< while it was commanded
  std::vector<FaultFigures> faults;
  double late_longest_s = 0.0;  ///< of this process: end of a cycle after its slot
};

std::string unitree_report_json(const UnitreeReport& report);
std::string unitree_report_lines(const UnitreeReport& report);

/// The simulated robot behind Unitree's DDS topics, in real time on CLOCK_MONOTONIC: 500 states a
/// second, and between two of them its drives evaluate the newest command at 4 kHz. Stricter than a
/// robot may be: it follows no command with a mistake.
class UnitreeBench {
 public:
  /// `walk_s`: how long the walk will be whose speed is measured; 0: all of it. Throws InputError.
  UnitreeBench(const ProcessConfig& config, std::vector<TimedUnitreeFault> faults, double walk_s);

  /// Plays as long as `more`, called in every fifth cycle, returns true. `controller`: the process
  /// that faults kill or stop; 0: none.
  UnitreeReport play(const std::function<bool()>& more, pid_t controller = 0);
  bool all_faults_made() const noexcept { return made_ == script_.size(); }
  /// Since the last command that the robot follows.
  double silent_s() const noexcept { return now_s() - commanded_s_; }

 private:
  struct Drive {
    double q_rad = 0.0, dq_radps = 0.0, tau_nm = 0.0, kp = 0.0, kd = 0.0;
    bool on = false;
  };
  struct QueuedState {
    std::int64_t due_ns;
    unitree::LowState state;
  };
  struct Place {
    double x_m, y_m;
  };

  double now_s() const noexcept;
  void follow(const unitree::LowCmd& command, double now_s);
  void damp_by_itself();
  void make_faults(double now_s);
  void make(const TimedUnitreeFault& fault, double now_s);
  void signal_controller(UnitreeFaultKind kind) const;
  void step();
  void send_state(std::int64_t now_ns);
  void send_due(std::int64_t now_ns);
  void observe(double now_s);
  UnitreeReport report();

  const ProcessConfig& config_;
  const double walk_s_;
  std::vector<TimedUnitreeFault> script_;
  std::size_t made_ = 0;
  std::vector<double> made_at_s_;
  UnitreePeer peer_;
  EmulatedRobot robot_;
  JointArray<Drive> drives_;
  JointArray<double> torque_nm_{};

  // Faults that last.
  double gap_until_s_ = 0.0, held_until_s_ = 0.0, late_s_ = 0.0, jitter_s_ = 0.0;
  int loses_ = 0;
  bool silent_ = false, bad_crc_ = false, no_crc_ = false, stuck_ = false, damps_ = false;
  bool sport_ = false;
  int nan_joint_ = -1, lost_joint_ = -1, foreign_left_ = 0;
  std::uint32_t back_ms_ = 0;
  unitree::RobotState state_;
  JointArray<std::optional<int>> mode_;  ///< that a motor reports, whatever is commanded

  std::deque<QueuedState> queue_;
  pid_t controller_ = 0;
  std::int64_t start_ns_ = 0;
  std::uint64_t cycle_ = 0;
  double enabled_at_s_ = -1.0, commanded_s_ = 0.0;
  std::uint64_t random_ = 1;
  std::vector<Place> walk_;
  Place lay_{};
  UnitreeReport report_;
};

}  // namespace sandrunner::hil
