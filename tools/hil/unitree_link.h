// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>

#include "drivers/unitree/unitree_config.h"
#include "sim/robot/robot_model.h"
#include "tools/hil/emulated/unitree_peer.h"
#include "tools/hil/link.h"

namespace sandrunner::hil {

/// A Unitree robot's end of its DDS topics: 500 states a second, and between two of them its drives
/// evaluate the newest command at 4 kHz. Stricter than a robot may be: it follows no command with a
/// mistake.
class UnitreeLink final : public Link {
 public:
  /// Throws InputError.
  UnitreeLink(const UnitreeConfig& config, const sim::Robot& robot,
              const sim::SimulatorConfig& simulator, std::span<const TimedFault> script);

  static std::span<const LinkFault<UnitreeLink>> faults();

  std::string greeting() const override;
  std::int64_t cycle_ns() const noexcept override;
  double exchange(std::int64_t end_ns) override;
  bool make(const TimedFault& fault, double now_s) override;
  const JointArray<DriveMoment>& step(double now_s, sim::Simulator& robot) override;
  LinkFigures figures(bool was_enabled) const override;

 private:
  struct Drive {
    double q_rad = 0.0, dq_radps = 0.0, tau_nm = 0.0, kp = 0.0, kd = 0.0;
    bool on = false;
  };
  struct QueuedState {
    std::int64_t due_ns;
    unitree::LowState state;
  };

  void follow(const unitree::LowCmd& command);
  void damp_by_itself();
  void send_foreign();
  void send_state(const sim::Simulator& robot, double now_s);
  void send_due(std::int64_t now_ns);

  const UnitreeConfig config_;
  const JointArray<double> torque_limit_nm_;
  const sim::DriveLine<double> line_;
  UnitreePeer peer_;
  JointArray<Drive> drives_;
  JointArray<DriveMoment> moments_;
  std::uint64_t cycle_ = 0;

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
  std::int64_t now_ns_ = 0;  ///< the cycle's states are made
  std::uint64_t random_ = 1;

  std::uint64_t states_ = 0, commands_ = 0;
  std::uint64_t refused_ = 0;   ///< commands that a robot may not follow ...
  std::string refusal_;         ///< ... and what was wrong with the first
  double longest_gap_s_ = 0.0;  ///< between two commands
};

}  // namespace sandrunner::hil
